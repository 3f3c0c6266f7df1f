#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <sstream>

#include "cli/format.h"
#include "common/image_file.h"
#include "tests/cli/run_command.h"
#include "tests/cli/scene_folder.h"

// What a person sees on a terminal, and what Ctrl-C does.

namespace strata::test {
namespace {

/// What is redrawn on the terminal, without escape sequences.
std::vector<std::string> DrawnLines(const std::string& shown) {
  std::vector<std::string> lines;
  std::string line;
  for (size_t i = 0; i < shown.size(); ++i) {
    if (shown[i] == '\x1b') {
      while (i < shown.size() && !std::isalpha(static_cast<unsigned char>(shown[i]))) ++i;
    } else if (shown[i] == '\r' || shown[i] == '\n') {
      if (!line.empty()) lines.push_back(line);
      line.clear();
    } else {
      line += shown[i];
    }
  }
  return lines;
}

TEST(Terminal, TheProgressLineIsRedrawnInPlaceAndFitsTheWidth) {
  const SceneFolder folder;
  RunningCommand render({"strata", "render", folder.LongScene(), "-o", folder.Path("out.exr")},
                        {.terminal_columns = 50});
  EXPECT_TRUE(render.WaitForError("samples/s"));
  render.Signal(SIGINT);
  const CommandResult result = render.Wait();
  EXPECT_EQ(result.exit_status, 130);
  EXPECT_NE(result.err.find("\r"), std::string::npos);
  for (const std::string& line : DrawnLines(result.err)) {
    if (line.find(" %") == std::string::npos || line.find("stopped") == 0) continue;
    EXPECT_LT(DisplayWidth(line), 50) << line;
  }
}

TEST(Terminal, WithoutOneThereAreNoEscapeSequences) {
  const SceneFolder folder;
  const CommandResult render = RunStrata({"render", folder.TinyScene()});
  EXPECT_EQ(render.err.find('\x1b'), std::string::npos);
  EXPECT_EQ(render.err.find('\r'), std::string::npos);
  EXPECT_NE(render.err.find(" %"), std::string::npos) << render.err;
}

TEST(Terminal, ErrorsAreColouredUnlessNoColorIsSet) {
  const std::vector<std::string> words = {"strata", "render", "missing.pbrt"};
  EXPECT_NE(RunningCommand(words, {.environment = {{"NO_COLOR", ""}}, .terminal_columns = 80})
                .Wait()
                .err.find("\x1b[31m"),
            std::string::npos);
  EXPECT_EQ(RunningCommand(words, {.environment = {{"NO_COLOR", "1"}}, .terminal_columns = 80})
                .Wait()
                .err.find("\x1b["),
            std::string::npos);
  EXPECT_EQ(RunStrata({"render", "missing.pbrt"}).err.find("\x1b["), std::string::npos);
}

TEST(Interrupt, RenderWritesTheImageSoFarAndLeavesNothingElse) {
  const SceneFolder folder;
  const std::string scene = folder.LongScene(), out = folder.Path("out.exr");
  std::filesystem::create_directory(folder.Path("tmp"));
  RunningCommand render({"strata", "render", scene, "-o", out, "--json"},
                        {.environment = {{"TMPDIR", folder.Path("tmp")}}});
  EXPECT_TRUE(render.WaitForOutput("\"samples\":[1-9]"));
  render.Signal(SIGINT);
  const CommandResult result = render.Wait();
  EXPECT_EQ(result.exit_status, 130) << result.err;
  EXPECT_NE(result.err.find("the image so far"), std::string::npos) << result.err;
  EXPECT_TRUE(ReadExr(out).ok()) << ReadExr(out).status();
  EXPECT_TRUE(std::filesystem::is_empty(folder.Path("tmp")));
}

TEST(Interrupt, WhileTheSceneIsReadEndsAtOnceAndLeavesNothing) {
  const SceneFolder folder;
  std::filesystem::create_directory(folder.Path("tmp"));
  // Reading this takes longer than the moment from the handler's being there to the signal's
  // coming; should it ever not, the job is cancelled, to the same end.
  std::string numbers;
  for (int i = 0; i < 3000000; ++i) numbers += "0.5 ";
  const std::string scene = folder.Write(
      "big.pbrt", "WorldBegin\nShape \"trianglemesh\" \"point3 P\" [" + numbers + "]\n");
  RunningCommand render({"strata", "render", scene},
                        {.environment = {{"TMPDIR", folder.Path("tmp")}}});
  EXPECT_TRUE(render.WaitForHandlerOf(SIGINT));
  render.Signal(SIGINT);
  const CommandResult result = render.Wait();
  EXPECT_EQ(result.exit_status, 130) << result.err;
  EXPECT_EQ(result.out, "");
  EXPECT_TRUE(std::filesystem::is_empty(folder.Path("tmp")));
}

}  // namespace
}  // namespace strata::test
