#include "cli/print/terminal_image.h"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "cli/client/errors.h"
#include "cli/print/braille.h"
#include "cli/top/screen.h"

namespace regrasp::cli {
namespace {

/// Five bits a channel: the bins in which colours are counted.
constexpr std::size_t kBins = 1 << 15;
std::size_t BinOf(const std::uint8_t* p) {
  return static_cast<std::size_t>((p[0] >> 3) << 10 | (p[1] >> 3) << 5 | p[2] >> 3);
}

using Color = std::array<int, 3>;

struct Palette {
  std::vector<Color> colors;
  std::vector<std::uint8_t> of_bin;  ///< colour of each bin that occurs
};

/// At most 255 colours: the box of bins with the longest side is halved again and again; each box
/// becomes the mean of its pixels.
Palette ReduceColors(const Image& image) {
  std::vector<std::array<long, 4>> sums(kBins);  // of red, green, blue; number of pixels
  for (std::size_t i = 0; i + 2 < image.rgb.size(); i += 3) {
    auto& sum = sums[BinOf(&image.rgb[i])];
    for (std::size_t c = 0; c < 3; ++c) sum[c] += image.rgb[i + c];
    ++sum[3];
  }
  const auto level = [](std::size_t bin, std::size_t channel) {
    return static_cast<int>(bin >> (10 - 5 * channel) & 31);
  };
  struct Bins {
    std::vector<std::size_t> bins;
    std::size_t channel = 0;  ///< along which it is longest
    int low = 0, side = 0;
  };
  const auto make = [&level](std::vector<std::size_t> bins) {
    Bins box{std::move(bins)};
    for (std::size_t c = 0; c < 3; ++c) {
      int low = 31, high = 0;
      for (const auto bin : box.bins) {
        low = std::min(low, level(bin, c));
        high = std::max(high, level(bin, c));
      }
      if (high - low > box.side) {
        box.channel = c;
        box.low = low;
        box.side = high - low;
      }
    }
    return box;
  };
  std::vector<std::size_t> occurring;
  for (std::size_t bin = 0; bin < kBins; ++bin)
    if (sums[bin][3] > 0) occurring.push_back(bin);
  std::vector<Bins> boxes = {make(std::move(occurring))};
  while (boxes.size() < 255) {
    const auto longest = std::max_element(
        boxes.begin(), boxes.end(), [](const Bins& a, const Bins& b) { return a.side < b.side; });
    if (longest->side == 0) break;
    const Bins box = *longest;
    const auto upper = [&](std::size_t bin) {
      return level(bin, box.channel) > box.low + box.side / 2;
    };
    std::vector<std::size_t> halves[2];
    for (const auto bin : box.bins) halves[upper(bin) ? 1 : 0].push_back(bin);
    *longest = make(std::move(halves[0]));
    boxes.push_back(make(std::move(halves[1])));
  }
  Palette palette{{}, std::vector<std::uint8_t>(kBins)};
  for (const Bins& box : boxes) {
    std::array<long, 4> sum{};
    for (const auto bin : box.bins) {
      for (std::size_t c = 0; c < 4; ++c) sum[c] += sums[bin][c];
      palette.of_bin[bin] = static_cast<std::uint8_t>(palette.colors.size());
    }
    Color mean{};
    for (std::size_t c = 0; c < 3; ++c)
      mean[c] = static_cast<int>((sum[c] + sum[3] / 2) / std::max(sum[3], 1L));
    palette.colors.push_back(mean);
  }
  return palette;
}

void AddRun(std::string* text, char sixel, int count) {
  if (count > 3) {
    *text += fmt::format("!{}{}", count, sixel);
  } else {
    text->append(static_cast<std::size_t>(count), sixel);
  }
}

/// Number in the 256-colour palette: its 6 x 6 x 6 cube, or its grey ramp where that is nearer.
int CubeColor(const std::uint8_t* p) {
  const auto step = [](int v) { return v < 48 ? 0 : v < 115 ? 1 : (v - 35) / 40; };
  const auto level = [](int s) { return s == 0 ? 0 : 55 + 40 * s; };
  const auto distance = [p](int r, int g, int b) {
    return (p[0] - r) * (p[0] - r) + (p[1] - g) * (p[1] - g) + (p[2] - b) * (p[2] - b);
  };
  const int r = step(p[0]), g = step(p[1]), b = step(p[2]);
  const int gray = std::clamp(((p[0] + p[1] + p[2]) / 3 - 3) / 10, 0, 23), g8 = 8 + 10 * gray;
  if (distance(g8, g8, g8) < distance(level(r), level(g), level(b))) return 232 + gray;
  return 16 + 36 * r + 6 * g + b;
}

int Brightness(const std::uint8_t* p) { return (299 * p[0] + 587 * p[1] + 114 * p[2]) / 1000; }

}  // namespace

Image DecodePng(const std::string& png, const std::string& name) {
  png_image header = {};
  header.version = PNG_IMAGE_VERSION;
  Image image;
  const png_color white = {255, 255, 255};
  if (png_image_begin_read_from_memory(&header, png.data(), png.size()) != 0) {
    header.format = PNG_FORMAT_RGB;
    image.width = static_cast<int>(header.width);
    image.height = static_cast<int>(header.height);
    image.rgb.resize(PNG_IMAGE_SIZE(header));
    if (png_image_finish_read(&header, &white, image.rgb.data(), 0, nullptr) != 0) return image;
  }
  const std::string cause = header.message;
  png_image_free(&header);
  throw CliError(kIo, fmt::format("{} is no PNG picture: {}", name, cause));
}

Image Resize(const Image& image, int width, int height) {
  Image small{width, height, {}};
  small.rgb.reserve(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  const auto begin = [](int i, int to, int from) {
    return static_cast<int>(static_cast<long>(i) * from / to);
  };
  for (int y = 0; y < height; ++y) {
    const int y0 = begin(y, height, image.height);
    const int y1 = std::max(begin(y + 1, height, image.height), y0 + 1);
    for (int x = 0; x < width; ++x) {
      const int x0 = begin(x, width, image.width);
      const int x1 = std::max(begin(x + 1, width, image.width), x0 + 1);
      long sum[3] = {0, 0, 0};
      for (int v = y0; v < y1; ++v)
        for (int u = x0; u < x1; ++u)
          for (int c = 0; c < 3; ++c) sum[c] += image.at(u, v)[c];
      const long count = static_cast<long>(y1 - y0) * (x1 - x0);
      for (const long s : sum)
        small.rgb.push_back(static_cast<std::uint8_t>((s + count / 2) / count));
    }
  }
  return small;
}

Size Fit(const Image& image, int width, int height) {
  const double scale = std::min(
      {1.0, static_cast<double>(width) / image.width, static_cast<double>(height) / image.height});
  return {std::max(static_cast<int>(std::lround(image.width * scale)), 1),
          std::max(static_cast<int>(std::lround(image.height * scale)), 1)};
}

std::string Base64(const std::string& bytes) {
  static constexpr char kLetters[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned word = 0;
    const std::size_t count = std::min<std::size_t>(bytes.size() - i, 3);
    for (std::size_t k = 0; k < 3; ++k)
      word = word << 8 | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      text += k <= count ? kLetters[word >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

std::string Kitty(const std::string& png, int columns) {
  constexpr std::size_t kChunk = 4096;
  const std::string data = Base64(png);
  std::string text;
  for (std::size_t i = 0; i < data.size(); i += kChunk) {
    text += i == 0 ? "\x1b_Ga=T,f=100,q=2," + (columns > 0 ? fmt::format("c={},", columns) : "")
                   : std::string("\x1b_G");
    text += fmt::format("m={};", i + kChunk < data.size() ? 1 : 0);
    text += data.substr(i, kChunk) + "\x1b\\";
  }
  return text + "\n";
}

std::string Sixel(const Image& image) {
  const Palette palette = ReduceColors(image);
  std::string text = fmt::format("\x1bP0;1q\"1;1;{};{}", image.width, image.height);
  for (std::size_t i = 0; i < palette.colors.size(); ++i) {
    const auto& c = palette.colors[i];
    const auto percent = [](int v) { return (100 * v + 127) / 255; };
    text += fmt::format("#{};2;{};{};{}", i, percent(c[0]), percent(c[1]), percent(c[2]));
  }
  const auto width = static_cast<std::size_t>(image.width);
  for (int top = 0; top < image.height; top += 6) {
    // Of each colour of this band of six rows: which rows it has in each column.
    std::vector<std::vector<std::uint8_t>> bits(palette.colors.size());
    for (int y = top; y < std::min(top + 6, image.height); ++y) {
      for (std::size_t x = 0; x < width; ++x) {
        auto& row = bits[palette.of_bin[BinOf(image.at(static_cast<int>(x), y))]];
        if (row.empty()) row.resize(width);
        row[x] = static_cast<std::uint8_t>(row[x] | 1u << (y - top));
      }
    }
    for (std::size_t color = 0; color < bits.size(); ++color) {
      if (bits[color].empty()) continue;
      text += fmt::format("#{}", color);
      for (std::size_t x = 0; x < width;) {
        const std::size_t begin = x;
        while (x < width && bits[color][x] == bits[color][begin]) ++x;
        AddRun(&text, static_cast<char>('?' + bits[color][begin]), static_cast<int>(x - begin));
      }
      text += '$';
    }
    text += '-';
  }
  return text + "\x1b\\\n";
}

std::string HalfBlocks(const Image& image, bool true_color) {
  const auto color = [true_color](int layer, const std::uint8_t* p) {
    return true_color ? fmt::format("{};2;{};{};{}", layer, p[0], p[1], p[2])
                      : fmt::format("{};5;{}", layer, CubeColor(p));
  };
  std::string text;
  for (int y = 0; y < image.height; y += 2) {
    std::string last;
    for (int x = 0; x < image.width; ++x) {
      // The lower half of an odd last row keeps the terminal's background.
      std::string code = color(38, image.at(x, y));
      code += y + 1 < image.height ? ";" + color(48, image.at(x, y + 1)) : ";49";
      if (code != last) text += "\x1b[" + code + "m";
      last = code;
      text += "▀";
    }
    text += "\x1b[0m\n";
  }
  return text;
}

std::string Dots(const Image& image) {
  std::array<int, 256> count{};
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      ++count[static_cast<std::size_t>(Brightness(image.at(x, y)))];
  const int background =
      static_cast<int>(std::max_element(count.begin(), count.end()) - count.begin());
  constexpr int kDiffers = 48;  // a fifth of the range: thin grey lines stay
  BrailleCanvas canvas((image.width + 1) / 2, (image.height + 3) / 4);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      if (std::abs(Brightness(image.at(x, y)) - background) > kDiffers) canvas.Set(x, y);
  std::string text;
  for (int row = 0; row < canvas.rows(); ++row) {
    std::string line;
    for (int column = 0; column < canvas.columns(); ++column)
      line += Utf8(canvas.Glyph(column, row));
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + '\n';
  }
  return text;
}

}  // namespace regrasp::cli
