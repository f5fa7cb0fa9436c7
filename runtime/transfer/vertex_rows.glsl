// Reads the rows of vertices (codebook.hpp), which say from which samples a vertex takes its light. A draw's rows
// are words of a page: vertex_count + 1 offsets of entries, then the entries' samples, then their weights, two to a
// word as unorm16.
uint rowWordAt(uint word);  // word of the rows page

struct VertexRows {
  uint word;  // first word in the page
  uint vertex_count;
  uint entries;
};

// Loops over rows end, whatever memory holds: a GPU that is busy for ever takes its machine with it. Rows have a few
// entries.
const uint kMostInRow = 65536u;

// Returns the range of a vertex's entries, [x, y).
uvec2 rowOf(VertexRows rows, uint vertex) {
  uint first = rowWordAt(rows.word + vertex);
  return uvec2(first, min(rowWordAt(rows.word + vertex + 1u), first + kMostInRow));
}

struct RowEntry {
  float weight;
  uint sample_index;
};

RowEntry rowEntryAt(VertexRows rows, uint entry) {
  uint samples_word = rows.word + rows.vertex_count + 1u;
  uint pair = rowWordAt(samples_word + rows.entries + (entry >> 1u));
  return RowEntry(float((pair >> (16u * (entry & 1u))) & 0xffffu) / 65535.0, rowWordAt(samples_word + entry));
}
