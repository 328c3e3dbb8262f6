#include "datasets/objects/object_shapes.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace landmarkdb::datasets {

namespace {

constexpr int kRound = 32;  // sides of what is turned

void add_ball(Workshop shop, const Eigen::Vector3d& centre, const Eigen::Vector3d& radii) {
  add_blob(shop.mesh,
           at(centre.x(), centre.y(), centre.z()),
           {.radii = radii,
            .squareness_z = shop.random.uniform(0.6, 1.1),
            .squareness_xy = shop.random.uniform(0.7, 1.1),
            .roughness = shop.random.uniform(0.02, 0.10),
            .wavelength = shop.random.uniform(0.4, 0.9),
            .seed = shop.random.next(),
            .detail = 16});
}

// A cylinder lying along y.
void add_wheel(Workshop shop, const Eigen::Vector3d& hub, double radius, double width) {
  const std::array<Eigen::Vector2d, 2> profile = {Eigen::Vector2d(radius, -0.5 * width),
                                                  Eigen::Vector2d(radius, 0.5 * width)};
  const Eigen::Isometry3d T = at(hub.x(), hub.y(), hub.z()) *
                              Eigen::AngleAxisd(0.5 * std::numbers::pi, Eigen::Vector3d::UnitX());
  add_revolution(shop.mesh, T, profile, kRound);
}

}  // namespace

void add_figurine(Workshop shop) {
  begin_object(shop.mesh, "figurine");
  Random& random = shop.random;
  const double h = random.uniform(0.14, 0.32);
  const double wide = h * random.uniform(0.16, 0.24);
  add_cylinder(shop.mesh, at(0, 0), wide * random.uniform(0.9, 1.3), 0.06 * h);
  for (const double side : {-1.0, 1.0}) {  // legs
    add_ball(shop,
             {side * 0.5 * wide, h * random.uniform(-0.04, 0.04), 0.2 * h},
             {0.45 * wide, 0.5 * wide, 0.17 * h});
  }
  add_ball(shop, {0, 0, 0.5 * h}, {wide, wide * random.uniform(0.6, 0.9), 0.22 * h});
  const double head = h * random.uniform(0.09, 0.13);
  const Eigen::Vector3d neck(h * random.uniform(-0.04, 0.04), -0.03 * h, 0.78 * h);
  add_ball(shop, neck, {head, head, 1.15 * head});
  add_ball(shop, neck + Eigen::Vector3d(0, -head, 0), {0.3 * head, 0.4 * head, 0.3 * head});
  const std::array<Eigen::Vector2d, 4> hat = {
      Eigen::Vector2d(head * random.uniform(1.0, 1.5), 0.0),
      Eigen::Vector2d(0.8 * head, 0.2 * head),
      Eigen::Vector2d(head * random.uniform(0.3, 1.1), head),
      Eigen::Vector2d(0.1 * head, 1.2 * head)};
  add_revolution(shop.mesh, at(neck.x(), neck.y(), neck.z() + 0.6 * head), hat, kRound);
  for (const double side : {-1.0, 1.0}) {
    const Eigen::Vector3d shoulder(side * 0.9 * wide, 0, 0.62 * h);
    const Eigen::Vector3d hand(side * wide * random.uniform(1.2, 2.2),
                               -h * random.uniform(0.02, 0.2),
                               h * random.uniform(0.35, 0.85));
    add_rod(shop.mesh, at(0, 0), shoulder, hand, 0.05 * h);
    add_ball(shop, hand, Eigen::Vector3d::Constant(h * random.uniform(0.05, 0.09)));
  }
}

void add_animal(Workshop shop) {
  begin_object(shop.mesh, "animal");
  Random& random = shop.random;
  const double l = random.uniform(0.14, 0.34);
  const double leg = l * random.uniform(0.22, 0.45);
  const double fat = l * random.uniform(0.17, 0.28);
  const Eigen::Vector3d body(0, 0, leg + 0.8 * fat);
  add_ball(shop, body, {0.5 * l, 0.8 * fat, fat});
  for (const double x : {-0.3, 0.3}) {
    for (const double y : {-0.5, 0.5}) {
      add_rod(shop.mesh,
              at(0, 0),
              {x * l + l * random.uniform(-0.08, 0.08), y * fat, 0.0},
              {x * l, y * fat, leg + 0.5 * fat},
              l * random.uniform(0.045, 0.075));
    }
  }
  const Eigen::Vector3d head =
      body +
      Eigen::Vector3d(0.58 * l, l * random.uniform(-0.1, 0.1), l * random.uniform(0.05, 0.3));
  const double skull = l * random.uniform(0.12, 0.17);
  add_rod(shop.mesh, at(0, 0), body + Eigen::Vector3d(0.3 * l, 0, 0), head, 0.6 * skull);
  add_ball(shop, head, {1.3 * skull, 0.9 * skull, skull});
  for (const double y : {-0.7, 0.7}) {
    const double ear = skull * random.uniform(0.5, 1.3);
    add_ball(
        shop, head + Eigen::Vector3d(-0.3 * skull, y * skull, skull), {0.3 * ear, 0.5 * ear, ear});
  }
  add_rod(shop.mesh,
          at(0, 0),
          body + Eigen::Vector3d(-0.4 * l, 0, 0.2 * fat),
          body + Eigen::Vector3d(
                     -0.7 * l, l * random.uniform(-0.1, 0.1), l * random.uniform(-0.2, 0.4)),
          0.04 * l);
}

void add_carton(Workshop shop) {
  begin_object(shop.mesh, "carton");
  Random& random = shop.random;
  const double a = random.uniform(0.05, 0.12);
  add_box(shop.mesh, at(0, 0), {a, a * random.uniform(1.3, 1.8), a * random.uniform(2.1, 2.8)});
}

void add_milk_carton(Workshop shop) {
  begin_object(shop.mesh, "milk carton");
  Random& random = shop.random;
  const double a = random.uniform(0.06, 0.10);
  const double b = a * random.uniform(0.9, 1.3);
  const double body = a * random.uniform(1.8, 2.6);
  const double gable = a * random.uniform(0.35, 0.6);
  add_box(shop.mesh, at(0, 0), {a, b, body});
  const std::array<Eigen::Vector2d, 3> roof = {
      Eigen::Vector2d(-0.5 * a, 0), Eigen::Vector2d(0.5 * a, 0), Eigen::Vector2d(0, gable)};
  Eigen::Isometry3d T = at(0, 0.5 * b, body);
  T.linear() = Eigen::AngleAxisd(0.5 * std::numbers::pi, Eigen::Vector3d::UnitX()).matrix();
  add_prism(shop.mesh, T, roof, b);
  add_box(shop.mesh, at(0, 0, body + 0.9 * gable), {0.05 * a, b, 0.25 * a});  // the seam
  const double slope = std::atan2(gable, 0.5 * a);
  Eigen::Isometry3d T_cap = at(0.25 * a, b * random.uniform(-0.15, 0.15), body + 0.45 * gable);
  T_cap.linear() = Eigen::AngleAxisd(0.5 * std::numbers::pi - (0.5 * std::numbers::pi - slope),
                                     Eigen::Vector3d::UnitY())
                       .matrix();
  add_cylinder(shop.mesh, T_cap, a * random.uniform(0.14, 0.2), a * random.uniform(0.15, 0.25));
}

void add_bottle(Workshop shop) {
  begin_object(shop.mesh, "bottle");
  Random& random = shop.random;
  const double h = random.uniform(0.15, 0.32);
  const double r = h * random.uniform(0.12, 0.22);
  const double neck = r * random.uniform(0.3, 0.5);
  const double shoulder = h * random.uniform(0.55, 0.75);
  std::vector<Eigen::Vector2d> profile = {{r, 0.0}, {r, shoulder}};
  for (int i = 1; i <= 6; ++i) {
    const double t = i / 6.0;
    profile.emplace_back(neck + (r - neck) * 0.5 * (1.0 + std::cos(std::numbers::pi * t)),
                         shoulder + 0.15 * h * t);
  }
  profile.emplace_back(neck, 0.93 * h);
  profile.emplace_back(1.3 * neck, 0.93 * h);
  profile.emplace_back(1.3 * neck, h);
  add_revolution(shop.mesh, at(0, 0), profile, 2 * kRound);
}

void add_spray_bottle(Workshop shop) {
  begin_object(shop.mesh, "spray bottle");
  Random& random = shop.random;
  const double h = random.uniform(0.18, 0.3);
  const double w = h * random.uniform(0.14, 0.2);
  add_blob(shop.mesh,
           at(0, 0, 0.33 * h),
           {.radii = {w, w * random.uniform(0.5, 0.75), 0.33 * h},
            .squareness_z = 0.35,
            .squareness_xy = 0.5,
            .roughness = 0.02,
            .seed = random.next(),
            .detail = 20});
  add_cylinder(shop.mesh, at(0, 0, 0.6 * h), 0.35 * w, 0.25 * h);
  add_box(shop.mesh, at(-0.25 * w, 0, 0.82 * h), {w * random.uniform(1.5, 2.2), 0.6 * w, 0.14 * h});
  add_rod(shop.mesh,
          at(0, 0),
          {-0.5 * w, 0, 0.84 * h},
          {-w * random.uniform(0.8, 1.2), 0, h * random.uniform(0.58, 0.7)},
          0.16 * w);
}

void add_mug(Workshop shop) {
  begin_object(shop.mesh, "mug");
  Random& random = shop.random;
  const double h = random.uniform(0.09, 0.15);
  const double r = h * random.uniform(0.38, 0.5);
  const double foot = r * random.uniform(0.7, 1.0);
  constexpr double kWall = 0.9;
  const std::array<Eigen::Vector2d, 5> profile = {Eigen::Vector2d(foot, 0.0),
                                                  Eigen::Vector2d(r, h),
                                                  Eigen::Vector2d(kWall * r, h),
                                                  Eigen::Vector2d(kWall * foot, 0.08 * h),
                                                  Eigen::Vector2d(0.002, 0.08 * h)};
  add_revolution(shop.mesh, at(0, 0), profile, 2 * kRound);
  const double reach = r * random.uniform(0.5, 0.9);
  const double thick = 0.08 * h;
  Eigen::Vector3d last(0.9 * r, 0, 0.82 * h);
  for (int i = 1; i <= 6; ++i) {
    const double t = std::numbers::pi * i / 6.0;
    const Eigen::Vector3d next(0.9 * r + reach * std::sin(t), 0, (0.52 + 0.3 * std::cos(t)) * h);
    add_rod(shop.mesh, at(0, 0), last, next, thick);
    last = next;
  }
}

void add_tool(Workshop shop) {
  begin_object(shop.mesh, "tool");
  Random& random = shop.random;
  const double h = random.uniform(0.16, 0.25);
  const double thick = h * random.uniform(0.2, 0.28);
  add_box(shop.mesh,
          at(random.uniform(-0.1, 0.1) * h, 0),
          {h * random.uniform(0.35, 0.55), 1.1 * thick, 0.16 * h});
  add_blob(shop.mesh,
           at(0, 0, 0.42 * h),
           {.radii = {0.13 * h, 0.45 * thick, 0.36 * h},
            .squareness_z = 0.4,
            .roughness = 0.05,
            .seed = random.next(),
            .detail = 14});
  const double back = h * random.uniform(0.2, 0.35);
  const double front = h * random.uniform(0.35, 0.6);
  const std::array<Eigen::Vector2d, 6> body = {Eigen::Vector2d(0.35 * thick, -back),
                                               Eigen::Vector2d(0.55 * thick, -0.8 * back),
                                               Eigen::Vector2d(0.6 * thick, 0.4 * front),
                                               Eigen::Vector2d(0.35 * thick, 0.7 * front),
                                               Eigen::Vector2d(0.3 * thick, front),
                                               Eigen::Vector2d(0.1 * thick, 1.1 * front)};
  Eigen::Isometry3d T = at(0, 0, 0.84 * h);
  T.linear() = Eigen::AngleAxisd(0.5 * std::numbers::pi, Eigen::Vector3d::UnitY()).matrix();
  add_revolution(shop.mesh, T, body, kRound);
}

void add_train(Workshop shop) {
  begin_object(shop.mesh, "train");
  Random& random = shop.random;
  const double l = random.uniform(0.18, 0.34);
  const double w = l * random.uniform(0.28, 0.38);
  const double wheel = l * random.uniform(0.09, 0.13);
  add_box(shop.mesh, at(0, 0, wheel), {l, w, 0.12 * l});
  const double cab = l * random.uniform(0.25, 0.38);
  add_box(shop.mesh,
          at(-0.5 * (l - cab), 0, wheel + 0.12 * l),
          {cab, w, l * random.uniform(0.3, 0.45)});
  const double boiler = 0.5 * w * random.uniform(0.7, 0.95);
  const std::array<Eigen::Vector2d, 3> tank = {Eigen::Vector2d(boiler, 0.0),
                                               Eigen::Vector2d(boiler, l - cab - 0.05 * l),
                                               Eigen::Vector2d(0.7 * boiler, l - cab)};
  Eigen::Isometry3d T = at(cab - 0.5 * l, 0, wheel + 0.12 * l + boiler);
  T.linear() = Eigen::AngleAxisd(0.5 * std::numbers::pi, Eigen::Vector3d::UnitY()).matrix();
  add_revolution(shop.mesh, T, tank, kRound);
  add_cylinder(shop.mesh,
               at(l * random.uniform(0.25, 0.38), 0, wheel + 0.12 * l + 1.8 * boiler),
               0.35 * boiler,
               l * random.uniform(0.1, 0.2));
  for (const double x : {-0.35, 0.0, 0.35}) {
    for (const double y : {-0.5, 0.5}) {
      add_wheel(shop, {x * l, y * w, wheel}, wheel, 0.05 * l);
    }
  }
}

}  // namespace landmarkdb::datasets
