#include <fmt/format.h>
#include <zlib.h>

#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

#include "snapshots/sheet.h"

namespace regrasp {
namespace {

std::string Escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else
      out += c;
  }
  return out;
}

std::string Base64(const std::vector<std::uint8_t>& bytes) {
  static constexpr char kDigits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t v = bytes[i] << 16;
    if (n > 1) v |= bytes[i + 1] << 8;
    if (n > 2) v |= bytes[i + 2];
    for (std::size_t k = 0; k < 4; ++k) out += k <= n ? kDigits[v >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

std::string Hex(Colour c) { return fmt::format("#{:02x}{:02x}{:02x}", c.r, c.g, c.b); }

class SvgSheet final : public Sheet {
 public:
  explicit SvgSheet(const SheetSize& size) {
    const double width = size.width_px / size.unit, height = size.height_px / size.unit;
    text_ = fmt::format(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{:.2f}mm\" height=\"{:.2f}mm\" "
        "viewBox=\"0 0 {:.2f} {:.2f}\" font-family=\"DejaVu Sans, sans-serif\" "
        "stroke-linecap=\"round\" stroke-linejoin=\"round\">\n"
        "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n",
        size.width_mm, size.width_mm * height / width, width, height);
  }

  void Clip(const Box& box) override {
    Unclip();
    ++clips_;
    Add(R"svg(<clipPath id="c{0}"><rect x="{1:.2f}" y="{2:.2f}" width="{3:.2f}" height="{4:.2f}"/></clipPath><g clip-path="url(#c{0})">)svg",
        clips_, box.x, box.y, box.width, box.height);
    clipped_ = true;
  }
  void Unclip() override {
    if (clipped_) Add("</g>");
    clipped_ = false;
  }
  void Stroke(std::span<const Point2> points, Colour colour, double width) override {
    Add(R"(<polyline points="{}" fill="none" stroke="{}" stroke-width="{:.2f}"/>)", Points(points),
        Hex(colour), width);
  }
  void Polygon(std::span<const Point2> corners, Colour fill) override {
    Add(R"(<polygon points="{}" fill="{}"/>)", Points(corners), Hex(fill));
  }
  void FillBox(const Box& box, Colour fill) override {
    Add(R"(<rect x="{:.2f}" y="{:.2f}" width="{:.2f}" height="{:.2f}" fill="{}"/>)", box.x, box.y,
        box.width, box.height, Hex(fill));
  }
  void Disc(Point2 centre, double radius, Colour fill) override {
    Add(R"(<circle cx="{:.2f}" cy="{:.2f}" r="{:.2f}" fill="{}"/>)", centre.x, centre.y, radius,
        Hex(fill));
  }
  void Circle(Point2 centre, double radius, Colour colour, double width) override {
    Add(R"(<circle cx="{:.2f}" cy="{:.2f}" r="{:.2f}" fill="none" stroke="{}" stroke-width="{:.2f}"/>)",
        centre.x, centre.y, radius, Hex(colour), width);
  }
  void Text(Point2 at, const std::string& utf8, const TextStyle& style) override {
    double down = 0;
    if (style.align_y == AlignY::kMiddle) down = kMiddleOfLine * style.size;
    if (style.align_y == AlignY::kTop) down = kTopOfLine * style.size;
    const char* anchor = style.align_x == AlignX::kLeft     ? "start"
                         : style.align_x == AlignX::kCentre ? "middle"
                                                            : "end";
    const std::string halo =
        style.halo > 0
            ? fmt::format(R"( paint-order="stroke" stroke="#ffffff" stroke-width="{:.2f}")",
                          2 * style.halo)
            : "";
    Add(R"(<text transform="translate({:.2f} {:.2f}){}" y="{:.2f}" font-size="{:.2f}" text-anchor="{}"{}{} fill="{}">{}</text>)",
        at.x, at.y, style.upwards ? " rotate(-90)" : "", down, style.size, anchor,
        style.bold ? R"( font-weight="bold")" : "", halo, Hex(style.colour), Escaped(utf8));
  }
  void Paste(const cv::Mat& bgr, const Box& box) override {
    std::vector<std::uint8_t> png;
    if (!cv::imencode(".png", bgr, png)) throw std::runtime_error("cannot encode the picture");
    Add(R"(<image x="{:.2f}" y="{:.2f}" width="{:.2f}" height="{:.2f}" href="data:image/png;base64,{}"/>)",
        box.x, box.y, box.width, box.height, Base64(png));
  }
  std::string Bytes() override {
    Unclip();
    return text_ + "</svg>\n";
  }

 private:
  template <typename... Args>
  void Add(fmt::format_string<Args...> format, Args&&... args) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<Args>(args)...);
    text_ += '\n';
  }
  static std::string Points(std::span<const Point2> points) {
    std::string out;
    for (const Point2& p : points)
      fmt::format_to(std::back_inserter(out), "{}{:.2f},{:.2f}", out.empty() ? "" : " ", p.x, p.y);
    return out;
  }

  std::string text_;
  int clips_ = 0;
  bool clipped_ = false;
};

}  // namespace

std::unique_ptr<Sheet> MakeSvgSheet(const SheetSize& size) {
  return std::make_unique<SvgSheet>(size);
}

}  // namespace regrasp
