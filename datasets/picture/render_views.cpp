#include "datasets/picture/render_views.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include "datasets/picture/point_layer.hpp"
#include "datasets/picture/storey_cut.hpp"
#include "engine/base/error.hpp"
#include "engine/geometry/pose.hpp"

namespace landmarkdb::datasets {
namespace {

const Colour kPaper(1.0F, 1.0F, 1.0F);
const Colour kInk(0.16F, 0.18F, 0.22F);
const Colour kFaintInk(0.52F, 0.55F, 0.60F);
const Colour kFloorGrey(0.89F, 0.90F, 0.92F);
const Colour kTopGrey(0.48F, 0.52F, 0.58F);
const Colour kPaleOrange(1.00F, 0.60F, 0.16F);
const Colour kOrange(0.97F, 0.42F, 0.02F);
const Colour kDeepOrange(0.85F, 0.33F, 0.0F);
const std::array<Colour, 3> kAxes = {
    Colour(0.85F, 0.12F, 0.15F), Colour(0.10F, 0.60F, 0.20F), Colour(0.13F, 0.32F, 0.85F)};

// The picture frame: x to the right, y into the distance of the side view, z up; metres.
struct Drawing {
  std::vector<Eigen::Vector3f> place, query;
  Eigen::Isometry3d T_drawing_sensor;
  Eigen::AlignedBox3f box;  // of most of the place's points and of all of the query
  StoreyCut storey;
};

// One panel: where a point of the drawing lands, and how near it is to the viewer.
struct Panel {
  int x = 0, y = 0, width = 0, height = 0;
  bool from_above = true;
  float scale = 1.0F;      // pixels a metre
  Eigen::Vector3f corner;  // drawing point at the panel's top left

  ViewPoint operator()(const Eigen::Vector3f& p) const {
    const Eigen::Vector3f d = p - corner;
    if (from_above) return {{scale * d.x(), -scale * d.y()}, p.z()};
    return {{scale * d.x(), -scale * d.z()}, -p.y()};
  }
  Eigen::Vector2f pixel(const Eigen::Vector3f& p) const {
    return (*this)(p).px + Eigen::Vector2f(static_cast<float>(x), static_cast<float>(y));
  }
};

std::vector<Eigen::Vector3f> carried(const PointCloud& cloud, const Eigen::Isometry3d& T) {
  const Eigen::Isometry3d with_origin = T * Eigen::Translation3d(cloud.origin);
  std::vector<Eigen::Vector3f> points;
  points.reserve(cloud.size());
  for (const Eigen::Vector3f& p : cloud.points) {
    if (p.allFinite()) points.emplace_back((with_origin * p.cast<double>()).cast<float>());
  }
  return points;
}

// The box without the outermost half per cent on each side: stray points do not shrink the place.
Eigen::AlignedBox3f inner_box(const std::vector<Eigen::Vector3f>& points) {
  Eigen::AlignedBox3f box;
  Eigen::Vector3f low, high;
  const std::size_t out = points.size() / 200;
  std::vector<float> values(points.size());
  for (int k = 0; k < 3; ++k) {
    std::transform(points.begin(), points.end(), values.begin(), [&](const Eigen::Vector3f& p) {
      return p[k];
    });
    std::nth_element(
        values.begin(), values.begin() + static_cast<std::ptrdiff_t>(out), values.end());
    low[k] = values[out];
    const std::size_t last = points.size() - 1 - out;
    std::nth_element(
        values.begin(), values.begin() + static_cast<std::ptrdiff_t>(last), values.end());
    high[k] = values[last];
  }
  box.extend(low);
  box.extend(high);
  return box;
}

Drawing lay_out(const PointCloud& place,
                const PointCloud& query,
                const Eigen::Isometry3d& T_scene_sensor,
                const Eigen::Vector3d& up) {
  constexpr float kAround_m = 0.35F;
  Drawing drawing;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();  // T_drawing_scene
  T.linear() = rotation_between(up, Eigen::Vector3d::UnitZ());
  const std::vector<Eigen::Vector3f> upright = carried(place, T);
  if (upright.empty()) {
    throw Error(ErrorCode::kInvalidArgument, "the place has no finite points to draw");
  }
  double turn = straighten_rad(upright);
  const Eigen::Vector3d forward = T.linear() * T_scene_sensor.linear().col(2);
  // The side view looks the way the camera does, so that what it saw lies behind it.
  const double into = std::sin(turn) * forward.x() + std::cos(turn) * forward.y();
  if (!query.empty() && into < 0.0) turn += std::numbers::pi;
  T = Eigen::Isometry3d(Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ())) * T;
  drawing.place = carried(place, T);
  drop_strays(drawing.place);
  drawing.T_drawing_sensor = T * T_scene_sensor;
  drawing.query = carried(query, drawing.T_drawing_sensor);
  drawing.box = inner_box(drawing.place);
  Eigen::Vector3f sensor = drawing.T_drawing_sensor.translation().cast<float>();
  if (query.empty()) {
    sensor = drawing.box.center();
    sensor.z() = drawing.box.min().z() + 1.5F;
  } else {
    for (const Eigen::Vector3f& p : drawing.query) drawing.box.extend(p);
    drawing.box.extend(sensor);
  }
  drawing.box.min().array() -= kAround_m;
  drawing.box.max().array() += kAround_m;
  drawing.storey = find_storey(drawing.place, sensor);
  return drawing;
}

// Points grow where there are few, so that surfaces close.
float radius_for(std::size_t points, float area_px2) {
  const float apart = std::sqrt(area_px2 / static_cast<float>(std::max<std::size_t>(points, 1)));
  return std::clamp(0.75F * apart, 0.5F, 2.6F);
}

void draw_place(Canvas& canvas, const Panel& panel, const Drawing& drawing) {
  // The section is cut a little before the sensor and the query.
  float cut = -1e30F;
  if (!drawing.query.empty()) {
    cut = static_cast<float>(drawing.T_drawing_sensor.translation().y());
    for (const Eigen::Vector3f& p : drawing.query) cut = std::min(cut, p.y());
    cut -= 0.25F;
  } else {
    cut = drawing.box.center().y();
  }
  std::vector<ViewPoint> points;
  for (const Eigen::Vector3f& p : drawing.place) {
    const bool shown = panel.from_above
                           ? p.z() > drawing.storey.floor_m && p.z() < drawing.storey.top_m
                           : p.y() > cut;
    if (shown) points.push_back(panel(p));
  }
  PointStyle style{
      .radius_px = radius_for(points.size(), static_cast<float>(panel.width * panel.height)),
      .far = kFloorGrey,
      .near = kTopGrey};
  if (panel.from_above) {
    style.far_m = drawing.storey.floor_m;
    style.near_m = drawing.storey.top_m;
  } else {
    style.far_m = -drawing.box.max().y();
    style.near_m = -cut;
  }
  draw_points(canvas, panel.x, panel.y, panel.width, panel.height, points, style);
}

void draw_query(Canvas& canvas, const Panel& panel, const Drawing& drawing) {
  std::vector<ViewPoint> points;
  float far = 1e30F;
  float near = -1e30F;
  for (const Eigen::Vector3f& p : drawing.query) {
    if (panel.from_above && p.z() > drawing.storey.top_m) continue;
    points.push_back(panel(p));
    far = std::min(far, points.back().nearness_m);
    near = std::max(near, points.back().nearness_m);
  }
  draw_points(canvas,
              panel.x,
              panel.y,
              panel.width,
              panel.height,
              points,
              {.radius_px = points.size() > 50'000 ? 0.6F : 1.3F,
               .far = kPaleOrange,
               .near = kOrange,
               .far_m = far,
               .near_m = near,
               .shading = 0.5F,
               .alpha = 0.92F});
}

void draw_sensor(Canvas& canvas,
                 const Panel& panel,
                 const Drawing& drawing,
                 const ViewsOptions& options) {
  const Eigen::Isometry3f T = drawing.T_drawing_sensor.cast<float>();
  const Eigen::Vector2f eye = panel.pixel(T.translation());
  if (options.frustum) {
    const Camera& camera = *options.frustum;
    const auto depth = static_cast<float>(options.frustum_m);
    std::array<Eigen::Vector2f, 4> corners;
    for (std::size_t i = 0; i < 4; ++i) {
      const double u = i == 0 || i == 3 ? 0.0 : camera.width;
      const double v = i < 2 ? 0.0 : camera.height;
      const Eigen::Vector3f ray(static_cast<float>((u - camera.cx) / camera.fx),
                                static_cast<float>((v - camera.cy) / camera.fy),
                                1.0F);
      corners[i] = panel.pixel(T * Eigen::Vector3f(depth * ray));
    }
    for (std::size_t i = 0; i < 4; ++i) {
      draw_line(canvas, eye, corners[i], 1.6F, kDeepOrange, 0.75F);
      draw_line(canvas, corners[i], corners[(i + 1) % 4], 1.6F, kDeepOrange, 0.75F);
    }
  }
  constexpr float kAxisLength_px = 30.0F;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3f tip = T.translation() + kAxisLength_px / panel.scale * T.linear().col(k);
    draw_line(canvas, eye, panel.pixel(tip), 5.5F, kPaper, 0.8F);
    draw_line(canvas, eye, panel.pixel(tip), 3.2F, kAxes[static_cast<std::size_t>(k)]);
  }
  draw_disc(canvas, eye, 6.0F, kPaper);
  draw_disc(canvas, eye, 4.2F, kInk);
}

// The longest of 1, 2, 5, 10, ... metres that takes at most a fifth of the panel.
void draw_scale_bar(Canvas& canvas, const Panel& panel, float left, float base) {
  double metres = 0.1;
  for (const double step : {0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0}) {
    if (step * panel.scale < 0.2 * panel.width) metres = step;
  }
  const float length = panel.scale * static_cast<float>(metres);
  draw_line(canvas, {left, base}, {left + length, base}, 2.4F, kInk);
  for (const float x : {left, left + length}) {
    draw_line(canvas, {x, base - 5.0F}, {x, base + 5.0F}, 2.4F, kInk);
  }
  std::array<char, 16> label{};
  std::snprintf(label.data(), label.size(), "%g m", metres);
  draw_text(canvas, {left + length + 12.0F, base + 6.0F}, label.data(), 12.0F, kInk);
}

float draw_key(Canvas& canvas, float x, float base, const Colour& colour, const std::string& text) {
  constexpr float kSize = 12.0F;
  draw_disc(canvas, {x + 6.0F, base - 0.5F * kSize}, 6.0F, colour);
  draw_text(canvas, {x + 20.0F, base}, text, kSize, kInk);
  return x + 20.0F + text_width(text, kSize) + 34.0F;
}

struct Sheet {
  Canvas canvas;
  Panel top, side;
};

constexpr int kMargin_px = 36;
constexpr int kTitle_px = 64;
constexpr int kLegend_px = 60;
constexpr int kCaption_px = 30;

Sheet make_sheet(const Drawing& drawing, const ViewsOptions& options) {
  const Eigen::Vector3f size = drawing.box.sizes();
  const bool beside = options.layout == Layout::kBeside;
  const int room = options.width_px - (beside ? 3 : 2) * kMargin_px;
  Panel top, side;
  top.scale = side.scale = static_cast<float>(room) / ((beside ? 2.0F : 1.0F) * size.x());
  top.width = side.width = static_cast<int>(top.scale * size.x());
  top.height = static_cast<int>(top.scale * size.y());
  side.height = static_cast<int>(side.scale * size.z());
  side.from_above = false;
  const int header = options.title.empty() ? kMargin_px : kTitle_px;
  top.x = kMargin_px;
  top.y = header + kCaption_px;
  side.x = beside ? 2 * kMargin_px + top.width : kMargin_px;
  side.y = beside ? top.y + std::max(0, (top.height - side.height) / 2)
                  : top.y + top.height + kMargin_px + kCaption_px;
  const int bottom = std::max(top.y + top.height, side.y + side.height);
  top.corner = {drawing.box.min().x(), drawing.box.max().y(), 0.0F};
  side.corner = {drawing.box.min().x(), 0.0F, drawing.box.max().z()};
  return {Canvas(options.width_px, bottom + kLegend_px, kPaper), top, side};
}

}  // namespace

Canvas render_views(const PointCloud& place,
                    const PointCloud& query,
                    const Eigen::Isometry3d& T_scene_sensor,
                    const ViewsOptions& options) {
  if (options.width_px < 400 || options.width_px > 8000) {
    throw Error(
        ErrorCode::kInvalidArgument,
        "the picture's width is " + std::to_string(options.width_px) + " pixels, want 400 to 8000");
  }
  const Drawing drawing = lay_out(place, query, T_scene_sensor, options.up);
  auto [canvas, top, side] = make_sheet(drawing, options);
  draw_text(canvas, {kMargin_px, 44.0F}, options.title, 18.0F, kInk);
  for (const Panel& panel : {top, side}) {
    draw_text(canvas,
              {static_cast<float>(panel.x), static_cast<float>(panel.y) - 12.0F},
              panel.from_above ? "from above, ceiling taken off" : "from the side, cut open",
              10.0F,
              kFaintInk);
    draw_place(canvas, panel, drawing);
    if (query.empty()) continue;
    draw_query(canvas, panel, drawing);
    draw_sensor(canvas, panel, drawing, options);
  }
  const float base = static_cast<float>(canvas.height) - 24.0F;
  draw_scale_bar(canvas, top, kMargin_px, base - 6.0F);
  float x = static_cast<float>(kMargin_px) + 0.2F * static_cast<float>(top.width) + 110.0F;
  x = draw_key(canvas, x, base, kTopGrey, options.place_label);
  if (!query.empty()) {
    x = draw_key(canvas, x, base, kOrange, options.query_label);
    x = draw_key(canvas, x, base, kInk, "sensor, its axes");
    for (std::size_t k = 0; k < 3; ++k) {
      constexpr std::array<const char*, 3> kNames = {"x", "y", "z"};
      draw_line(canvas, {x - 20.0F, base - 6.0F}, {x, base - 6.0F}, 3.2F, kAxes[k]);
      draw_text(canvas, {x + 8.0F, base}, kNames[k], 12.0F, kInk);
      x += 52.0F;
    }
  }
  return std::move(canvas);
}

}  // namespace landmarkdb::datasets
