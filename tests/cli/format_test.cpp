#include "cli/format.h"

#include <gtest/gtest.h>

#include "cli/suggestion.h"

namespace strata {
namespace {

TEST(Format, DurationsAreReadAtAGlance) {
  EXPECT_EQ(FormatDuration(0.8412), "0.84 s");
  EXPECT_EQ(FormatDuration(9.999), "10 s");
  EXPECT_EQ(FormatDuration(59.6), "1 min 00 s");
  EXPECT_EQ(FormatDuration(185), "3 min 05 s");
  EXPECT_EQ(FormatDuration(7380), "2 h 03 min");
  EXPECT_EQ(FormatDuration(4 * 86400 + 7 * 3600), "4 d 07 h");
}

TEST(Format, CountsHaveThreeDigitsAndAPrefix) {
  EXPECT_EQ(FormatCount(0), "0");
  EXPECT_EQ(FormatCount(950), "950");
  EXPECT_EQ(FormatCount(999.7), "1.00 k");
  EXPECT_EQ(FormatCount(12345), "12.3 k");
  EXPECT_EQ(FormatCount(1234567), "1.23 M");
  EXPECT_EQ(FormatCount(999999), "1.00 M");
  EXPECT_EQ(FormatBytes(812), "812 B");
  EXPECT_EQ(FormatBytes(1.5e9), "1.50 GB");
}

TEST(Format, PercentagesHaveTwoSignificantDigits) {
  EXPECT_EQ(FormatPercent(0), "0 %");
  EXPECT_EQ(FormatPercent(0.42), "42 %");
  EXPECT_EQ(FormatPercent(0.0996), "10 %");
  EXPECT_EQ(FormatPercent(0.0312), "3.1 %");
  EXPECT_EQ(FormatPercent(0.00312), "0.31 %");
  EXPECT_EQ(FormatPercent(0.000312), "0.031 %");
}

TEST(Format, ControlCharactersOfOtherPeopleDoNotReachTheTerminal) {
  EXPECT_EQ(Printable("evil\x1b[2Jname\n"), "evil?[2Jname?");
  EXPECT_EQ(Printable("Küche"), "Küche");
}

TEST(Format, TablesAreAlignedByWhatIsSeenAndEndWithoutBlanks) {
  Table table({{"NAME"}, {"N", true}, {"STATE"}});
  table.Add({"Küche", "7", "done"});
  table.Add({"a", "1234", "-"});
  const std::vector<std::string> expected = {
      "NAME      N  STATE",
      "Küche     7  done",
      "a      1234  -",
  };
  EXPECT_EQ(table.Lines(), expected);
}

TEST(Suggestion, DistancesCountSwapsOnce) {
  EXPECT_EQ(EditDistance("render", "render"), 0);
  EXPECT_EQ(EditDistance("rendre", "render"), 1);
  EXPECT_EQ(EditDistance("kitten", "sitting"), 3);
  EXPECT_EQ(EditDistance("", "abc"), 3);
}

TEST(Suggestion, OnlyNearWordsAreSuggested) {
  const std::vector<std::string> known = {"--spp", "--seed", "--resolution"};
  EXPECT_EQ(NearestWord("--sppp", known), "--spp");
  EXPECT_EQ(NearestWord("--resolutoin", known), "--resolution");
  EXPECT_EQ(NearestWord("--wavelength", known), "");
}

}  // namespace
}  // namespace strata
