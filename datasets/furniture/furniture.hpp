#pragma once

#include <Eigen/Geometry>

#include "datasets/shapes/shapes.hpp"
#include "engine/base/random.hpp"

// Things that stand in places. `T` carries the thing's frame to the scene: its origin on the floor
// (or on the wall, ceiling or table it is fixed to), z up, its front towards -y. Each draws its own
// size and shape from `random`, so no two are quite alike.
namespace landmarkdb::datasets {

struct Workshop {  // where a thing is built
  TriangleMesh& mesh;
  Random& random;
};

// office.cpp
void add_desk(Workshop shop, const Eigen::Isometry3d& T);  // with what lies on it, and a chair
void add_office_chair(Workshop shop, const Eigen::Isometry3d& T);
void add_shelf(Workshop shop, const Eigen::Isometry3d& T, double width);
void add_cabinet(Workshop shop, const Eigen::Isometry3d& T);
void add_bin(Workshop shop, const Eigen::Isometry3d& T);
void add_partition(Workshop shop, const Eigen::Isometry3d& T, double length);
void add_table_with_chairs(Workshop shop, const Eigen::Isometry3d& T, double length, int seats);

// lounge.cpp
void add_sofa(Workshop shop, const Eigen::Isometry3d& T, double width);
void add_low_table(Workshop shop, const Eigen::Isometry3d& T);
void add_plant(Workshop shop, const Eigen::Isometry3d& T);
void add_floor_lamp(Workshop shop, const Eigen::Isometry3d& T);
void add_bench(Workshop shop, const Eigen::Isometry3d& T, double width);
void add_reception(Workshop shop, const Eigen::Isometry3d& T);  // a curved counter
void add_vending_machine(Workshop shop, const Eigen::Isometry3d& T);
void add_kiosk(Workshop shop, const Eigen::Isometry3d& T);

// stone.cpp
void add_round_column(Workshop shop, const Eigen::Isometry3d& T, double radius, double height);
void add_square_column(Workshop shop, const Eigen::Isometry3d& T, double width, double height);
void add_statue(Workshop shop, const Eigen::Isometry3d& T, double height);
void add_altar(Workshop shop, const Eigen::Isometry3d& T);
void add_urn(Workshop shop, const Eigen::Isometry3d& T);
void add_rubble(Workshop shop, const Eigen::Isometry3d& T, int blocks);
void add_stele(Workshop shop, const Eigen::Isometry3d& T);

// fittings.cpp: the frame lies on the wall's face, z up, the wall towards +y
void add_picture(Workshop shop, const Eigen::Isometry3d& T);
void add_radiator(Workshop shop, const Eigen::Isometry3d& T, double width);
void add_vent(Workshop shop, const Eigen::Isometry3d& T);
void add_extinguisher(Workshop shop, const Eigen::Isometry3d& T);
void add_wall_box(Workshop shop, const Eigen::Isometry3d& T);  // switchboard, letter boxes
void add_sign(Workshop shop, const Eigen::Isometry3d& T);      // stands out from the wall
void add_door_frame(Workshop shop, const Eigen::Isometry3d& T, double width, double height);
// The frame hangs on the ceiling: z up, the thing below z = 0.
void add_ceiling_lamp(Workshop shop, const Eigen::Isometry3d& T);
void add_pendant_lamp(Workshop shop, const Eigen::Isometry3d& T, double drop);
void add_pipe_run(Workshop shop, const Eigen::Isometry3d& T, double length);  // along x
void add_duct(Workshop shop, const Eigen::Isometry3d& T, double length);      // along x

// stairs.cpp: climbs along +y from the origin
void add_stairs(Workshop shop, const Eigen::Isometry3d& T, double width, double height);
void add_railing(Workshop shop, const Eigen::Isometry3d& T, double length);  // along x

// goods.cpp
void add_crates(Workshop shop, const Eigen::Isometry3d& T, int count);
void add_barrel(Workshop shop, const Eigen::Isometry3d& T);
void add_car(Workshop shop, const Eigen::Isometry3d& T);
void add_rack(Workshop shop, const Eigen::Isometry3d& T, double length, double height);
void add_pallet(Workshop shop, const Eigen::Isometry3d& T);
void add_ladder(Workshop shop, const Eigen::Isometry3d& T);
// Something small, of any of a dozen kinds; at most 0.5 m from the origin.
void add_clutter(Workshop shop, const Eigen::Isometry3d& T);

}  // namespace landmarkdb::datasets
