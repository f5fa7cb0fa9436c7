// Chooses the resolution of pictures, in pixels per window pixel along an edge: the one that the user asked
// for, or a lower one while the picture moves if full pictures take long. It does not use the GPU; the
// renderer reports the times.
#pragma once

namespace lambent::editor {

class PictureScale {
 public:
  float whole = 1.0f;  // the user's choice, 0.25..2

  // Returns the scale of the next picture.
  float now() const { return coarse_ ? whole * moving_ : whole; }
  bool coarse() const { return coarse_; }
  // Call this when a picture was rendered. moves: another will follow soon, and may be coarse.
  void drawn(bool moves) { coarse_ = moves && moving_ < 1.0f; }
  // Call this with the time of a picture at full resolution.
  void wholeTook(double milliseconds);
  // Call this when nothing moves any more. The next picture has full resolution. Returns whether the last did
  // not.
  bool settle();

 private:
  float moving_ = 1.0f;  // factor on `whole` while the picture moves
  bool coarse_ = false;
};

}  // namespace lambent::editor
