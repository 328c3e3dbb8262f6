#include "datasets/picture/canvas.hpp"

#include <fstream>

#include <gtest/gtest.h>
#include <unistd.h>

#include "engine/base/error.hpp"

namespace landmarkdb::datasets {
namespace {

const Colour kWhite(1, 1, 1);
const Colour kBlack(0, 0, 0);

TEST(Blend, MixesByItsAlphaAndKeepsInside) {
  Canvas canvas(4, 4, kWhite);
  blend(canvas, 1, 2, kBlack, 0.25F);
  EXPECT_NEAR(canvas.at(1, 2).x(), 0.75, 1e-6);
  blend(canvas, -1, 0, kBlack, 1.0F);
  blend(canvas, 4, 4, kBlack, 1.0F);
  EXPECT_EQ(canvas.at(3, 3), kWhite);
}

TEST(DrawLine, CoversItsMiddleAndFadesAtItsEdge) {
  Canvas canvas(20, 20, kWhite);
  draw_line(canvas, {2, 10}, {18, 10}, 2.0F, kBlack);
  EXPECT_EQ(canvas.at(10, 9), kBlack);
  EXPECT_EQ(canvas.at(10, 10), kBlack);
  EXPECT_EQ(canvas.at(10, 5), kWhite);
  draw_line(canvas, {-1e7F, 3}, {1e7F, 3}, 2.0F, kBlack);  // far outside: no harm
}

TEST(WritePng, WritesAPngOfTheCanvas) {
  const auto path =
      std::filesystem::temp_directory_path() / ("landmarkdb-" + std::to_string(getpid()) + ".png");
  write_png(path, Canvas(30, 20, kWhite));
  std::ifstream in(path, std::ios::binary);
  std::string head(24, '\0');
  in.read(head.data(), 24);
  EXPECT_EQ(head.substr(1, 3), "PNG");
  EXPECT_EQ(head[19], 30);
  EXPECT_EQ(head[23], 20);
  std::filesystem::remove(path);
}

TEST(WritePng, SaysWhenThePathCannotBeWritten) {
  EXPECT_THROW(write_png("/nowhere/at/all.png", Canvas(4, 4, kWhite)), Error);
  EXPECT_THROW(write_png("/dev/full", Canvas(400, 400, kWhite)), Error);
}

}  // namespace
}  // namespace landmarkdb::datasets
