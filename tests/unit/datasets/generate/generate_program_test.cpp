#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>
#include <unistd.h>

namespace landmarkdb::datasets {
namespace {

namespace fs = std::filesystem;

struct Ended {
  int status = -1;
  std::string out;
};

// Runs the program; standard error goes to nowhere.
Ended generate(const std::string& arguments) {
  const char* bin = std::getenv("LANDMARKDB_BIN");
  const std::string command = std::string(bin == nullptr ? "." : bin) + "/landmarkdb-generate " +
                              arguments + " 2>/dev/null";
  Ended run;
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return run;
  char text[512];
  while (const std::size_t n = fread(text, 1, sizeof text, pipe)) run.out.append(text, n);
  const int status = pclose(pipe);
  run.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return run;
}

class GenerateProgram : public ::testing::Test {
 protected:
  GenerateProgram()
      : folder_(fs::temp_directory_path() / ("landmarkdb-generate-" + std::to_string(getpid()))) {}
  ~GenerateProgram() override { fs::remove_all(folder_); }
  fs::path folder_;
};

TEST_F(GenerateProgram, ListsTheTypesOfPlace) {
  const Ended run = generate("list");
  EXPECT_EQ(run.status, 0);
  EXPECT_THAT(run.out, ::testing::HasSubstr("temple"));
}

TEST_F(GenerateProgram, MakesAPlaceAndDrawsIt) {
  const std::string out = folder_.string();
  const Ended made =
      generate("place --type office --size 0.5 --points 20000 --queries 1 --json --out " + out);
  ASSERT_EQ(made.status, 0);
  const auto object = nlohmann::json::parse(made.out);
  EXPECT_EQ(object.at("points"), 20'000);
  const Ended drawn =
      generate("picture --width 500 --place " + out + " --query " + out + "/query-000.ply --pose " +
               out + "/query-000.pose.txt --out " + out + "/picture.png");
  EXPECT_EQ(drawn.status, 0);
  EXPECT_GT(fs::file_size(folder_ / "picture.png"), 5'000U);
}

TEST_F(GenerateProgram, MakesManyPlaces) {
  const Ended run = generate("many --count 7 --points 2000 --queries 0 --size 0.5 --json --out " +
                             folder_.string());
  ASSERT_EQ(run.status, 0);
  EXPECT_EQ(nlohmann::json::parse(run.out).at("places").size(), 7U);
  EXPECT_TRUE(fs::exists(folder_ / "place-0006" / "manifest.json"));
}

TEST_F(GenerateProgram, EndsWithTheStatusOfWhatWentWrong) {
  EXPECT_EQ(generate("").status, 2);
  EXPECT_EQ(generate("place").status, 2);
  EXPECT_EQ(generate("place --type cathedral --out " + folder_.string()).status, 2);
  EXPECT_EQ(generate("place --type hall --paper --out " + folder_.string()).status, 2);
  EXPECT_EQ(generate("picture --place /nowhere.ply --out /tmp/x.png").status, 7);
  EXPECT_EQ(generate("picture --place a.ply --query b.ply --out /tmp/x.png").status, 2);
}

TEST_F(GenerateProgram, ExplainsItself) {
  const Ended run = generate("place --help");
  EXPECT_EQ(run.status, 0);
  EXPECT_THAT(run.out, ::testing::HasSubstr("--paper"));
}

}  // namespace
}  // namespace landmarkdb::datasets
