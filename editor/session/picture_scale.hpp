// Chooses how many pixels a picture has for each pixel of the window along an edge: what the user asks for,
// and fewer while the picture moves if whole ones take long. A value without a GPU: whoever draws tells it
// what pictures took.
#pragma once

namespace lambent::editor {

class PictureScale {
 public:
  float whole = 1.0f;  // asked for, 0.25..2

  // Returns the scale of the next picture.
  float now() const { return coarse_ ? whole * moving_ : whole; }
  bool coarse() const { return coarse_; }
  // Says that a picture is drawn, and whether it moves: then another follows soon, which may be coarse.
  void drawn(bool moves) { coarse_ = moves && moving_ < 1.0f; }
  // Says how long a whole picture took.
  void wholeTook(double milliseconds);
  // Says that nothing moves any more: the next picture is whole. Returns whether the last was not.
  bool settle();

 private:
  float moving_ = 1.0f;  // factor while it moves
  bool coarse_ = false;
};

}  // namespace lambent::editor
