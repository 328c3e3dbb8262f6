#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "engine/types/mono_model.hpp"

namespace landmarkdb {

// Four points of a model, ascending, and the views in which they are looked up.
struct ChosenQuad {
  std::array<std::uint16_t, 4> ids{};
  ViewMask views{};
};

// Of the points in a pair's circle, those that are looked at where no links guide: nearest to its
// middle.
inline constexpr std::size_t kNearMiddle = 9;

// Whether a model's quads are chosen by its edges: two among the four points. Models without edges
// have quads of any near points.
bool is_linked(const MonoModel& model);

// The mean of a model's points.
Eigen::Vector3d mean_point(const MonoModel& model);

// Axes of a camera that looks against `direction`, from far away: x right, y down, rows.
Eigen::Matrix<double, 2, 3> image_axes(const Eigen::Vector3d& direction);

// The quads of a model that are looked up, each once, in an order of their own (a hash of their
// ids, so that neighbouring views keep the same ones). `seen`: of each point, the views that see
// it.
//
// Cost: some 5 ms for a model of 20 points; what follows from the choice takes a tenth of that.
std::vector<ChosenQuad> choose_quads(const MonoModel& model, std::span<const ViewMask> seen);

// The numbers that the choice depends on, as text: another text, another choice.
std::string quad_choice_params();

}  // namespace landmarkdb
