#include "cli/lab/report.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "cli/lab/figure.h"
#include "common/image_file.h"

namespace strata::lab {
namespace {

Outcome Sample() {
  Outcome outcome;
  outcome.records = {{"name", "V"},
                     {{std::string("a, b"), 0.123456789}, {std::string("c"), kNone}}};
  outcome.remarks = {"A remark."};
  outcome.caption = "A caption.";
  Plot plot = {.title = "It's a title", .x_label = "x", .y_label = "y", .log_y = true};
  plot.series = {{"measured", {{1, 2}, {3, 4}}}, {"theory", {{1, 1}}, true}};
  outcome.figure = plot;
  return outcome;
}

std::filesystem::path Folder() {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("strata_lab_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  return folder;
}

TEST(LabReport, TextIsAlignedCsvIsExactAndMarkdownIsATable) {
  const Experiment& experiment = Experiments().front();
  const std::vector<std::string> text = TextLines(experiment, Sample());
  EXPECT_NE(std::find(text.begin(), text.end(), "name       V"), text.end());
  EXPECT_NE(std::find(text.begin(), text.end(), "a, b  0.1235"), text.end());
  EXPECT_NE(std::find(text.begin(), text.end(), "c          -"), text.end());
  EXPECT_EQ(text.back(), "A remark.");
  EXPECT_EQ(CsvLines(Sample().records),
            (std::vector<std::string>{"name,V", "\"a, b\",0.123456789", "c,"}));
  const std::vector<std::string> markdown = MarkdownLines(experiment, Sample(), "p.png");
  EXPECT_EQ(markdown.front(), "## quadrature");
  EXPECT_NE(std::find(markdown.begin(), markdown.end(), "![A caption.](p.png)"), markdown.end());
  EXPECT_NE(std::find(markdown.begin(), markdown.end(), "| --- | ---: |"), markdown.end());
  EXPECT_NE(std::find(markdown.begin(), markdown.end(), "| a, b | 0.1235 |"), markdown.end());
}

TEST(LabFigure, TheScriptQuotesWhatItIsGiven) {
  const std::string script = GnuplotScript(std::get<Plot>(Sample().figure), "it's.svg");
  EXPECT_NE(script.find("set terminal svg"), std::string::npos);
  EXPECT_NE(script.find("set output 'it''s.svg'"), std::string::npos);
  EXPECT_NE(script.find("set title 'It''s a title'"), std::string::npos);
  EXPECT_NE(script.find("set logscale y"), std::string::npos);
  EXPECT_EQ(script.find("set logscale x"), std::string::npos);
  EXPECT_NE(script.find("$series0 << END\n1 2\n3 4\nEND\n"), std::string::npos);
}

TEST(LabFigure, OtherKindsOfFilesAreRefusedBeforeTheWork) {
  const Experiment& plot = *FindExperiment("importance");
  const Experiment& picture = *FindExperiment("mis");
  EXPECT_EQ(CheckFigure(plot, "a.jpg").code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(CheckFigure(picture, "a.svg").code(), absl::StatusCode::kInvalidArgument);
  EXPECT_TRUE(CheckFigure(picture, "a.png").ok());
  // Without a path to programs there is no gnuplot.
  const std::string path = std::getenv("PATH");
  setenv("PATH", "/nonexistent", 1);
  const absl::Status missing = CheckFigure(plot, "a.png");
  setenv("PATH", path.c_str(), 1);
  EXPECT_EQ(missing.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_NE(missing.message().find("apt install gnuplot-nox"), std::string::npos);
}

TEST(LabFigure, PicturesAreWrittenByTheImageWriter) {
  Outcome outcome;
  outcome.figure = Picture{2, 1, {0, 0, 0, 0.5f, 0.5f, 0.5f}};
  const std::filesystem::path file = Folder() / "picture.png";
  ASSERT_TRUE(WriteFigure(outcome, file).ok());
  const auto read = ReadImageFile(file);
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(read->width, 2);
  EXPECT_EQ(read->height, 1);
  EXPECT_LT(read->values[0], 0.01f);
  EXPECT_GT(read->values[3], 0.7f);  // As sRGB.
  std::filesystem::remove_all(Folder());
}

TEST(LabFigure, PlotsAreDrawnByGnuplot) {
  if (!CheckFigure(*FindExperiment("importance"), "a.png").ok()) {
    GTEST_SKIP() << "gnuplot is not installed";
  }
  for (const char* name : {"plot.png", "plot.svg"}) {
    const std::filesystem::path file = Folder() / name;
    ASSERT_TRUE(WriteFigure(Sample(), file).ok());
    EXPECT_GT(std::filesystem::file_size(file), 1000u);
  }
  EXPECT_FALSE(WriteFigure(Sample(), "/nonexistent/plot.png").ok());
  std::filesystem::remove_all(Folder());
}

}  // namespace
}  // namespace strata::lab
