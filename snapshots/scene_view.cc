#include "snapshots/scene_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

namespace regrasp {
namespace {

constexpr double kScaleBar = 0.02;  // [m]
constexpr double kCoarse = 4;       // pixels of the picture per cell of drawn_

cv::Mat RenderWith(double detail, std::span<const Body> bodies, const Camera& camera,
                   cv::Size size) {
  if (detail == 1) return Render(bodies, camera, size);
  Camera coarse = camera;
  coarse.focal_px *= detail;
  coarse.centre_x_px = (camera.centre_x_px + 0.5) * detail - 0.5;
  coarse.centre_y_px = (camera.centre_y_px + 0.5) * detail - 0.5;
  const cv::Size less(cvRound(size.width * detail), cvRound(size.height * detail));
  cv::Mat picture;
  cv::resize(Render(bodies, coarse, less), picture, size, 0, 0, cv::INTER_LINEAR);
  return picture;
}

}  // namespace

SceneView::SceneView(Canvas* canvas, const Box& box, std::span<const Body> bodies,
                     const Vector3d& to_viewer, const Vector3d& up, double detail)
    : canvas_(canvas), box_(box) {
  const cv::Size size = canvas->PixelsOf(box);
  // Room above for names and directions, below for the scales; a narrow sheet has it at the
  // sides.
  const double unit = canvas->scale(), above = canvas->narrow() ? 40 : 46;
  const double below = canvas->narrow() ? 14 : 74;
  camera_ = FitCamera(bodies, to_viewer, up,
                      size - cv::Size(0, static_cast<int>((above + below) * unit)), 34 * unit);
  camera_.centre_y_px += above * unit;
  const cv::Mat picture = RenderWith(detail, bodies, camera_, size);
  canvas->Paste(picture, box);
  cv::Mat grey;
  cv::extractChannel(picture, grey, 1);
  cv::resize(grey, grey, {}, 1 / kCoarse, 1 / kCoarse, cv::INTER_NEAREST);
  cv::integral(grey != 255, drawn_, CV_32S);
  taken_ = {{box.x, box.y, box.width, 34},        // what is seen
            {box.x, box.y, 150, 120},             // axes
            {box.br().x - 120, box.y, 120, 140},  // gravity
            {box.x, box.br().y - 84, 240, 84}};   // scales
}

void SceneView::Force(const Vector3d& p_W, const Vector3d& f_W, double metres_per_newton,
                      Colour dot) {
  const Point2 head = At(p_W), tail = At(p_W - f_W * metres_per_newton);
  canvas_->Disc(head, 7, kWhite);
  canvas_->Disc(head, 5.2, dot);
  canvas_->Arrow(tail, head, {kInk, 3.6}, 1.6);
  taken_.push_back(Box(Point2(std::min(head.x, tail.x), std::min(head.y, tail.y)),
                       Point2(std::max(head.x, tail.x) + 1, std::max(head.y, tail.y) + 1)));
}

void SceneView::Label(const Vector3d& p_W, Point2 from, const std::string& text, Colour colour) {
  const double width = canvas_->TextWidth(text, 20, true), height = 24;
  const Point2 at = At(p_W);
  Point2 away = at - from;
  away *= 1 / std::max(1.0, cv::norm(away));
  Point2 best = at;
  double best_cost = 1e30;
  for (double distance : {40.0, 56.0, 74.0, 96.0, 122.0})
    for (int i = 0; i < 16; ++i) {
      const double a = i * std::numbers::pi / 8;
      const Point2 direction(std::cos(a), std::sin(a));
      const Point2 centre =
          at + Point2(direction.x * (distance + width / 2 - 10), direction.y * distance);
      const Box room(centre.x - width / 2 - 4, centre.y - height / 2 - 2, width + 8, height + 4);
      double cost = 0.8 * distance - 20 * direction.dot(away) + 90 * Covered(room);
      for (const Box& other : taken_) cost += 3 * std::sqrt((room & other).area());
      if ((room & box_).area() < room.area() - 1) cost += 1e4;
      if (cost < best_cost) best_cost = cost, best = centre;
    }
  taken_.push_back({best.x - width / 2 - 4, best.y - height / 2 - 2, width + 8, height + 4});
  canvas_->Line(at, at + (best - at) * std::max(0.0, 1 - 17 / cv::norm(best - at)), {kInk, 1.2});
  canvas_->Text(
      best, text,
      {.size = 20, .colour = colour, .align_x = AlignX::kCentre, .bold = true, .halo = 2.5});
}

void SceneView::Directions(const Vector3d& gravity_W) {
  const Matrix3d& R_CW = camera_.X_CW.linear();
  const auto draw = [&](Point2 origin, const Vector3d& direction_W, double length, const Pen& pen,
                        const std::string& name, Colour colour) {
    const Vector3d d = R_CW * direction_W;
    const Point2 on_sheet(d.x(), d.y());
    if (cv::norm(on_sheet) < 0.42) {  // along the line of sight: a ring with a dot or a cross
      canvas_->Disc(origin, 9, kWhite);
      canvas_->Circle(origin, 9, {pen.colour, 2});
      if (d.z() < 0)
        canvas_->Disc(origin, 3, pen.colour);
      else
        canvas_->Mark(Marker::kCross, origin, 6, pen.colour);
      canvas_->Text(origin + Point2(-22, 16), name, {.size = 18, .colour = colour});
      return;
    }
    const Point2 head = origin + on_sheet * length;
    canvas_->Arrow(origin, head, pen);
    canvas_->Text(head + on_sheet * (16 / cv::norm(on_sheet)), name,
                  {.size = 18, .colour = colour, .align_x = AlignX::kCentre});
  };
  const Point2 triad = box_.tl() + Point2(70, 78);
  std::array<int, 3> order = {0, 1, 2};  // what points at the viewer goes on top
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return std::abs(R_CW(2, a)) < std::abs(R_CW(2, b)); });
  static constexpr std::array<const char*, 3> kNames = {"x", "y", "z"};
  for (int k : order) draw(triad, Vector3d::Unit(k), 46, {kGrey, 2.4}, kNames[k], kGrey);
  if (gravity_W.norm() > 1e-6)
    draw({box_.br().x - 70, box_.y + 66}, gravity_W.normalized(), 62, {kInk, 4}, "g", kInk);
}

void SceneView::Scales(const Vector3d& p_WO, double newton, double metres_per_newton) {
  const double per_metre = PerMetreAt(p_WO);
  const Point2 at(box_.x + 24, box_.br().y - 58);
  const Point2 end = at + Point2(kScaleBar * per_metre, 0);
  canvas_->Line(at, end, {kInk, 2.5});
  for (const Point2& p : {at, end}) canvas_->Line(p - Point2(0, 6), p + Point2(0, 6), {kInk, 2.5});
  canvas_->Text(end + Point2(12, 0), fmt::format("{:.0f} mm", kScaleBar * 1e3),
                {.size = 18, .halo = 2});
  if (newton <= 0) return;
  const Point2 tail = at + Point2(0, 32),
               head = tail + Point2(newton * metres_per_newton * per_metre, 0);
  canvas_->Arrow(tail, head, {kInk, 3.6});
  canvas_->Text({std::max(head.x, end.x) + 12, head.y}, fmt::format("{:g} N", newton),
                {.size = 18, .halo = 2});
}

double SceneView::Covered(const Box& room) const {
  const double k = canvas_->scale() / kCoarse;
  const auto column = [&](double x) {
    return std::clamp(static_cast<int>((x - box_.x) * k), 0, drawn_.cols - 1);
  };
  const auto row = [&](double y) {
    return std::clamp(static_cast<int>((y - box_.y) * k), 0, drawn_.rows - 1);
  };
  const int x0 = column(room.x), x1 = column(room.br().x), y0 = row(room.y), y1 = row(room.br().y);
  const double sum = drawn_(y1, x1) - drawn_(y0, x1) - drawn_(y1, x0) + drawn_(y0, x0);
  return sum / 255 / std::max(1, (x1 - x0) * (y1 - y0));
}

}  // namespace regrasp
