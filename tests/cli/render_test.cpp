#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>

#include "cli/job_options.h"
#include "common/image_file.h"
#include "common/job.h"
#include "common/replay_command.h"
#include "tests/cli/run_command.h"
#include "tests/cli/scene_folder.h"
#include "worker/integrator/render.h"

namespace strata::test {
namespace {

using nlohmann::json;

std::vector<std::string> Lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// The "done" event of a render with --json.
json Done(const std::vector<std::string>& arguments) {
  const CommandResult render = RunStrata(arguments);
  EXPECT_EQ(render.exit_status, 0) << render.err;
  const std::vector<std::string> lines = Lines(render.out);
  return lines.empty() ? json() : json::parse(lines.back());
}

TEST(Render, WritesAllLayersAndTellsInTheHeaderWhatTheyAre) {
  const SceneFolder folder;
  const std::string out = folder.Path("out.exr");
  const CommandResult render =
      RunStrata({"render", folder.TinyScene(), "-o", out, "--png", "--crop", "2,1,22,15", "--seed",
                 "5", "--channels", "alpha,albedo,normal,depth", "--threads", "2"});
  ASSERT_EQ(render.exit_status, 0) << render.err;

  const absl::StatusOr<ImageLayers> image = ReadExr(out);
  ASSERT_TRUE(image.ok()) << image.status();
  EXPECT_EQ(image->full_width, 24);
  EXPECT_EQ(image->full_height, 16);
  EXPECT_EQ(image->crop, (PixelRect{2, 1, 22, 15}));
  const std::set<std::string> channels(image->channels.begin(), image->channels.end());
  const std::set<std::string> expected = {
      "R",          "G",          "B",         "A",        "albedo.R", "albedo.G",
      "albedo.B",   "normal.X",   "normal.Y",  "normal.Z", "depth.Z",  "stderr.R",
      "stderr.G",   "stderr.B",   "ci95.R",    "ci95.G",   "ci95.B",   "variance.R",
      "variance.G", "variance.B", "samples.Y", "flags.Y"};
  EXPECT_EQ(channels, expected);

  const std::map<std::string, std::string> header(image->metadata.begin(), image->metadata.end());
  EXPECT_EQ(header.at("seed"), "5");
  EXPECT_EQ(header.at("spp"), "16");
  EXPECT_EQ(header.at("samples"), std::to_string(20 * 14 * 16));
  EXPECT_EQ(header.at("sceneDigest").find("sha256:"), 0u);
  EXPECT_NE(header.at("build"), "");
  const std::string digest = header.at("digest");
  EXPECT_NE(render.out.find(digest), std::string::npos) << render.out;

  const absl::StatusOr<ImageFile> png = ReadImageFile(folder.Path("out.png"));
  ASSERT_TRUE(png.ok()) << png.status();
  EXPECT_EQ(png->width, 20);
  EXPECT_EQ(png->height, 14);
}

TEST(Render, ReportsFilesSamplesErrorAndDigestInPlainWords) {
  const SceneFolder folder;
  const std::string out = folder.Path("out.exr");
  const CommandResult render = RunStrata({"render", folder.TinyScene(), "-o", out});
  ASSERT_EQ(render.exit_status, 0) << render.err;
  for (const std::string& part : {out, std::string("6.14 k samples (16 per pixel)"),
                                  std::string("99 % of pixels are within ±"),
                                  std::string("(95 % confidence)"), std::string("sha256:")}) {
    EXPECT_NE(render.out.find(part), std::string::npos) << part << " in:\n" << render.out;
  }
}

TEST(Render, APngAloneIsWrittenByItsExtension) {
  const SceneFolder folder;
  const std::string out = folder.Path("look.png");
  ASSERT_EQ(RunStrata({"render", folder.TinyScene(), "-o", out}).exit_status, 0);
  const absl::StatusOr<ImageFile> png = ReadImageFile(out);
  ASSERT_TRUE(png.ok()) << png.status();
  EXPECT_TRUE(png->eight_bit);
  EXPECT_FALSE(std::filesystem::exists(folder.Path("look.exr")));
}

TEST(Render, WithJsonEveryLineOfOutputIsAnEventAndTheLastIsDone) {
  const SceneFolder folder;
  const CommandResult render = RunStrata({"render", folder.TinyScene(), "--json", "--quiet"});
  ASSERT_EQ(render.exit_status, 0) << render.err;
  EXPECT_EQ(render.err, "");
  const std::vector<std::string> lines = Lines(render.out);
  ASSERT_FALSE(lines.empty());
  for (size_t i = 0; i + 1 < lines.size(); ++i) {
    EXPECT_EQ(json::parse(lines[i])["event"], "progress");
  }
  const json done = json::parse(lines.back());
  EXPECT_EQ(done["event"], "done");
  EXPECT_EQ(done["samples"], 24 * 16 * 16);
  EXPECT_EQ(done["spp_mean"], 16);
  EXPECT_EQ(done["nonfinite"], 0);
  EXPECT_EQ(done["target_met"], true);
  EXPECT_GT(done["rays"], done["samples"]);
  EXPECT_GT(done["rel_error"], 0);
  EXPECT_GT(done["mean_rgb"][0], done["mean_rgb"][2]) << "the lamp is warm";
}

TEST(Render, APictureThatCannotBeWrittenIsAFailureWithPathAndReason) {
  const SceneFolder folder;
  const std::string out = folder.Path("out.exr");
  // A directory where the image is written before it gets its name.
  std::filesystem::create_directories(out + ".part/full");
  const CommandResult render = RunStrata({"render", folder.TinyScene(), "-o", out, "--json"});
  EXPECT_EQ(render.exit_status, 1);
  EXPECT_EQ(render.err.find(out + ": cannot be written: "), 0u) << render.err;
  ASSERT_FALSE(Lines(render.out).empty());
  EXPECT_EQ(json::parse(Lines(render.out).back())["event"], "done") << "it is not lost";

  const CommandResult told = RunStrata({"render", folder.TinyScene(), "-o", out, "--quiet"});
  EXPECT_EQ(told.exit_status, 1);
  EXPECT_NE(told.out.find("samples"), std::string::npos) << told.out;
  EXPECT_EQ(told.out.find("out.exr"), std::string::npos) << told.out;
}

TEST(Render, TheDigestDoesNotDependOnThreadsWorkersOrTiles) {
  const SceneFolder folder;
  const std::string scene = folder.TinyScene();
  const json one = Done({"render", scene, "--json", "--threads", "1"});
  EXPECT_EQ(Done({"render", scene, "--json", "--threads", "4"})["digest"], one["digest"]);
  EXPECT_EQ(Done({"render", scene, "--json", "--workers", "2", "--threads", "1"})["digest"],
            one["digest"]);
  EXPECT_EQ(Done({"render", scene, "--json", "--tile", "8", "--threads", "2"})["digest"],
            one["digest"]);
  // The control: another seed is another render.
  EXPECT_NE(Done({"render", scene, "--json", "--seed", "1"})["digest"], one["digest"]);
}

TEST(Render, EachSamplerGivesTheSameBitsForAnyNumberOfWorkers) {
  const SceneFolder folder;
  const std::string scene = folder.TinyScene();
  for (const char* sampler :
       {"halton", "halton_plain", "stratified", "latin_hypercube", "poisson_disk", "drand48"}) {
    const std::vector<std::string> job = {"render", scene, "--json", "--sampler", sampler};
    const auto with = [&](std::vector<std::string> more) {
      more.insert(more.begin(), job.begin(), job.end());
      return Done(more)["digest"];
    };
    const json one = with({"--threads", "1"});
    EXPECT_EQ(with({"--workers", "2", "--threads", "1", "--tile", "8"}), one) << sampler;
  }
}

TEST(Render, WhereNoIntervalIsClaimedReportAndImageSaySo) {
  const SceneFolder folder;
  const std::string out = folder.Path("out.exr");
  const CommandResult render =
      RunStrata({"render", folder.TinyScene(), "-o", out, "--sampler", "halton_plain"});
  ASSERT_EQ(render.exit_status, 0) << render.err;
  EXPECT_NE(render.out.find("no interval is claimed"), std::string::npos) << render.out;
  EXPECT_EQ(render.out.find("95 %"), std::string::npos) << render.out;
  EXPECT_EQ(render.out.find("worst tiles"), std::string::npos) << render.out;
  const absl::StatusOr<ImageLayers> image = ReadExr(out);
  ASSERT_TRUE(image.ok()) << image.status();
  const std::vector<std::string>& channels = image->channels;
  for (const std::string& channel : channels) {
    EXPECT_EQ(channel.find("stderr"), std::string::npos);
    EXPECT_EQ(channel.find("ci95"), std::string::npos);
  }
  const auto flags = std::find(channels.begin(), channels.end(), "flags.Y") - channels.begin();
  for (size_t i = static_cast<size_t>(flags); i < image->values.size(); i += channels.size())
    ASSERT_NE(static_cast<uint32_t>(image->values[i]) & kFlagNoInterval, 0u);
  const std::map<std::string, std::string> header(image->metadata.begin(), image->metadata.end());
  EXPECT_EQ(header.at("interval"), "none claimed");
  EXPECT_EQ(header.at("sampler"), "halton_plain");
  EXPECT_EQ(header.at("strategy"), "mis");
  EXPECT_EQ(header.at("roulette"), "throughput");

  const CommandResult refused =
      RunStrata({"render", folder.TinyScene(), "--sampler", "drand48", "--error", "5%"});
  EXPECT_EQ(refused.exit_status, 2);
  EXPECT_NE(refused.err.find("drand48 claims no interval"), std::string::npos) << refused.err;
}

TEST(Render, SamplesThatAreNotFiniteAreCountedAndReplayableAndTheImageIsKept) {
  const SceneFolder folder;
  // A sky as bright as a float can be: the diffuse floor that gathers it overflows, the sky seen
  // past it does not.
  const std::string scene = folder.Write("bright.pbrt", R"(Camera "perspective"
Film "rgb" "integer xresolution" [16] "integer yresolution" [16]
Sampler "independent" "integer pixelsamples" [16]
WorldBegin
LightSource "infinite" "rgb L" [3e38 3e38 3e38]
Material "diffuse" "rgb reflectance" [0.9 0.9 0.9]
Shape "trianglemesh" "point3 P" [-9 -1 -9  9 -1 -9  9 -1 9  -9 -1 9] "integer indices" [0 2 1 0 3 2]
)");
  const std::string out = folder.Path("out.exr");
  const CommandResult render = RunStrata({"render", scene, "-o", out, "--quiet"});
  EXPECT_EQ(render.exit_status, 1);
  std::smatch count;
  ASSERT_TRUE(std::regex_search(render.err, count,
                                std::regex("([1-9][0-9]*) samples were NaN or infinite")))
      << render.err;
  const absl::StatusOr<ImageLayers> image = ReadExr(out);
  ASSERT_TRUE(image.ok()) << image.status();
  // The variance of such radiances is more than a float can hold, the picture itself is not.
  ASSERT_EQ(image->channels[0], "R");
  for (size_t i = 0; i < image->values.size(); i += image->channels.size()) {
    for (size_t channel = 0; channel < 3; ++channel) {
      ASSERT_TRUE(std::isfinite(image->values[i + channel])) << "value " << i;
    }
  }

  const CommandResult json_render = RunStrata({"render", scene, "--json", "--quiet"});
  EXPECT_EQ(json_render.exit_status, 1);
  EXPECT_EQ(std::to_string(json::parse(Lines(json_render.out).back())["nonfinite"].get<uint64_t>()),
            count[1]);

  // The command that is named runs, and shows the sample that was not finite.
  std::smatch command;
  ASSERT_TRUE(std::regex_search(render.err, command, std::regex("replay it with: strata (.*)")))
      << render.err;
  std::vector<std::string> words;
  std::istringstream stream(command[1]);
  for (std::string word; stream >> word;) words.push_back(word);
  const CommandResult replay = RunStrata(words, {.directory = folder.Path("")});
  EXPECT_EQ(replay.exit_status, 0) << replay.err;
  EXPECT_TRUE(std::regex_search(replay.out, std::regex("inf|nan"))) << replay.out;
}

TEST(Render, RoundingOfSamplesIsSaid) {
  const SceneFolder folder;
  const CommandResult render = RunStrata({"render", folder.TinyScene(), "--spp", "9"});
  EXPECT_EQ(render.exit_status, 0);
  EXPECT_NE(render.err.find("--spp 9 is rounded up to 16"), std::string::npos) << render.err;
}

TEST(Render, LeavesNothingInTheTemporaryDirectory) {
  const SceneFolder folder;
  const std::string scene = folder.TinyScene();
  std::filesystem::create_directory(folder.Path("tmp"));
  const CommandResult render =
      RunStrata({"render", scene}, {.environment = {{"TMPDIR", folder.Path("tmp")}}});
  EXPECT_EQ(render.exit_status, 0) << render.err;
  EXPECT_TRUE(std::filesystem::is_empty(folder.Path("tmp")));
}

TEST(Replay, TellsAPathVertexByVertexAndTheSameEachTime) {
  const SceneFolder folder;
  const std::vector<std::string> words = {
      "replay", folder.TinyScene(), "--pixel", "12,8", "--replicate", "3", "--sample", "1"};
  const CommandResult first = RunStrata(words);
  EXPECT_EQ(first.exit_status, 0) << first.err;
  EXPECT_NE(first.out, "");
  EXPECT_EQ(RunStrata(words).out, first.out);
}

TEST(Replay, APixelOutsideTheFrameIsRefused) {
  const SceneFolder folder;
  const CommandResult replay = RunStrata(
      {"replay", folder.TinyScene(), "--pixel", "24,0", "--replicate", "0", "--sample", "0"});
  EXPECT_EQ(replay.exit_status, 2);
  EXPECT_NE(replay.err.find("--pixel: 24,0 is outside"), std::string::npos) << replay.err;
}

TEST(Replay, TheCommandThatIsNamedTracesTheSampleOfTheJob) {
  const SceneFolder folder;
  folder.Write("paint.pbrt", "Material \"diffuse\" \"rgb reflectance\" [0.5 0.4 0.3]\n");
  const std::string scene = folder.Write("my room/it's.pbrt", R"(Camera "perspective"
Film "rgb" "integer xresolution" [24] "integer yresolution" [16] "integer pixelbounds" [0 4 0 4]
PixelFilter "mitchell" "float xradius" 1.7 "float yradius" 0.1234567891 "float B" 0.1 "float C" 0.7
Integrator "path" "integer maxdepth" [2]
WorldBegin
LightSource "infinite"
Include "../paint.pbrt"
Shape "sphere"
)");
  JobOptions options;
  options.scene = scene;
  options.root = folder.Path("");
  options.crop = "8,4,20,12";
  for (const auto& [seed, filter] : std::map<uint64_t, std::optional<std::string>>{
           {7, std::nullopt}, {8, "gaussian:1.25,0.3,0.61"}}) {
    options.seed = seed;
    options.filter = filter;
    const absl::StatusOr<ResolvedJob> job = ResolveJob(options);
    ASSERT_TRUE(job.ok()) << job.status();
    const auto loaded = LoadScene(DirectorySource(job->root), job->spec.bundle.scene);
    ASSERT_TRUE(loaded.ok()) << loaded.status();
    const auto renderer = Renderer::Create(*loaded, job->spec);
    ASSERT_TRUE(renderer.ok()) << renderer.status();

    const std::string command = "cd " + ShellQuoted(folder.Path("")) + " && " STRATA_BIN_DIR "/" +
                                ReplayCommand(job->spec, 12, 8, 3, 5);
    std::FILE* shell = popen(command.c_str(), "r");
    ASSERT_NE(shell, nullptr);
    std::string out;
    char block[4096];
    for (size_t n; (n = std::fread(block, 1, sizeof block, shell)) > 0;) out.append(block, n);
    EXPECT_EQ(pclose(shell), 0) << command;
    EXPECT_EQ(out, (*renderer)->Replay(12, 8, 3, 5) + "\n") << command;
  }
}

}  // namespace
}  // namespace strata::test
