#include "cli/run/gif.h"

#include <cmath>
#include <unordered_map>

#include "cli/run/palette.h"
#include "cli/run/write_failure.h"

namespace regrasp::run {
namespace {

constexpr int kRootBits = 8, kMaxBits = 12;

/// Codes of growing width, in blocks of at most 255 bytes.
class Blocks {
 public:
  explicit Blocks(std::ostream* out) : out_(out) {}
  void Put(int code, int bits) {
    word_ |= static_cast<std::uint32_t>(code) << filled_;
    for (filled_ += bits; filled_ >= 8; filled_ -= 8, word_ >>= 8) Byte(word_ & 255);
  }
  void Finish() {
    if (filled_ > 0) Byte(word_ & 255);
    Flush();
    out_->put(0);
  }

 private:
  void Byte(std::uint32_t byte) {
    block_.push_back(static_cast<char>(byte));
    if (block_.size() == 255) Flush();
  }
  void Flush() {
    if (block_.empty()) return;
    out_->put(static_cast<char>(block_.size()));
    *out_ << block_;
    block_.clear();
  }
  std::ostream* out_;
  std::string block_;
  std::uint32_t word_ = 0;
  int filled_ = 0;
};

}  // namespace

Gif::Gif(const std::string& path, int width, int height, double delay_s)
    : path_(path),
      out_(path, std::ios::binary),
      width_(width),
      height_(height),
      delay_(delay_s * 100) {
  out_ << "GIF89a";
  Number(width);
  Number(height);
  out_.put('\x70').put(0).put(0);  // 8 bits a channel; each picture has colours of its own
  out_ << std::string("\x21\xff\x0bNETSCAPE2.0\x03\x01\0\0\0", 19);  // again and again
}

void Gif::Number(int value) {
  out_.put(static_cast<char>(value & 255)).put(static_cast<char>(value >> 8 & 255));
}

void Gif::Add(std::span<const std::uint8_t> bgr) {
  owed_ += delay_;  // so that rounding does not add up
  const int delay = static_cast<int>(std::lround(owed_));
  owed_ -= delay;
  out_ << std::string("\x21\xf9\x04\0", 4);
  Number(delay);
  out_.put(0).put(0);
  out_.put('\x2c');
  Number(0);
  Number(0);
  Number(width_);
  Number(height_);
  const std::vector<Bgr> palette = PaletteOf(bgr);
  const std::vector<std::uint8_t> indices = Dithered(bgr, width_, palette);
  out_.put('\x87');  // 256 colours, red first
  for (std::size_t i = 0; i < 256; ++i) {
    const Bgr colour = i < palette.size() ? palette[i] : Bgr{};
    for (const std::size_t k : {2, 1, 0}) out_.put(static_cast<char>(colour[k]));
  }
  out_.put(kRootBits);
  constexpr int kClear = 1 << kRootBits, kEnd = kClear + 1;
  Blocks blocks(&out_);
  std::unordered_map<int, int> codes;  // (code of a string, next pixel) -> code of both
  int bits = kRootBits + 1, next = kEnd + 1;
  blocks.Put(kClear, bits);
  int string = indices.front();
  for (std::size_t i = 1; i < indices.size(); ++i) {
    const int pixel = indices[i];
    if (const auto known = codes.find(string << 8 | pixel); known != codes.end()) {
      string = known->second;
      continue;
    }
    blocks.Put(string, bits);
    codes[string << 8 | pixel] = next;
    if (next++ == 1 << bits) ++bits;
    if (bits > kMaxBits) {
      blocks.Put(kClear, kMaxBits);
      codes.clear();
      bits = kRootBits + 1;
      next = kEnd + 1;
    }
    string = pixel;
  }
  blocks.Put(string, bits);
  blocks.Put(kEnd, bits);
  blocks.Finish();
}

void Gif::Finish() {
  out_.put('\x3b');
  out_.close();
  if (!out_) FailToWrite(path_);
}

}  // namespace regrasp::run
