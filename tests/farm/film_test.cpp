// The film's file: what is written is read, damage is seen, and its size is bounded by the frame.

#include <gmock/gmock.h>

#include <fstream>

#include "coordinator/film.h"
#include "coordinator/next_round.h"
#include "coordinator/ordered_merge.h"
#include "tests/farm/farm_fixture.h"

namespace strata {
namespace {

using ::testing::HasSubstr;

class FilmTest : public ::testing::Test {
 protected:
  FilmTest() {
    spec_.width = spec_.height = 40;
    spec_.crop = {1, 2, 38, 35};
    spec_.tile = 16;
    spec_.spp = 64;
    spec_.channels.normal = true;
    path_ = directory_.path() / "a.film";
  }
  std::unique_ptr<Film> Create() {
    auto film = Film::Create(path_, {FilmLayer::kPath, {spec_.crop, spec_.tile}, LayoutOf(spec_)});
    EXPECT_TRUE(film.ok()) << film.status();
    return *std::move(film);
  }
  static void MergeAll(Film& film, const JobSpec& spec) {
    const auto plan = std::make_shared<const RoundPlan>(PlanFirstRound(spec));
    OrderedMerge merge(film, plan);
    for (uint32_t t = 0; t < plan->grid.Count(); ++t) {
      merge.Add(FakeRender(spec, *plan->Unit({0, t, 0})), 1);
    }
  }
  void Damage(std::streamoff offset) {
    std::fstream file(path_, std::ios::in | std::ios::out | std::ios::binary);
    file.seekg(offset);
    const char byte = static_cast<char>(file.get() ^ 1);
    file.seekp(offset);
    file.put(byte);
  }

  TestDirectory directory_;
  std::filesystem::path path_;
  JobSpec spec_;
};

TEST_F(FilmTest, IsReadAsItWasWritten) {
  std::unique_ptr<Film> film = Create();
  MergeAll(*film, spec_);
  const Digest digest = film->ResultDigest();
  const FilmGeometry geometry = film->geometry();
  film.reset();
  const auto read = Film::Open(path_);
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ((*read)->geometry(), geometry);
  EXPECT_EQ((*read)->ResultDigest(), digest);
  EXPECT_EQ((*read)->Front(0), (MergeFront{0, 1}));
  EXPECT_EQ((*read)->At(10, 10).counts->samples, 8u);
}

TEST_F(FilmTest, HoldsWhatTheWorkerSentForAPixel) {
  const std::unique_ptr<Film> film = Create();
  MergeAll(*film, spec_);
  const RoundPlan plan = PlanFirstRound(spec_);
  const uint32_t tile = plan.grid.IndexOf(20, 30);
  const Partial partial = FakeRender(spec_, *plan.Unit({0, tile, 0}));
  const PixelRect rect = plan.grid.Rect(tile);
  const size_t i = static_cast<size_t>((30 - rect.y0) * rect.Width() + (20 - rect.x0));
  EXPECT_EQ(film->At(20, 30).counts->rays, partial.rays[i]);
  const size_t doubles = static_cast<size_t>(partial.layout.Doubles());
  for (size_t k = 0; k < doubles; ++k) {
    EXPECT_EQ(film->At(20, 30).values[k], partial.values[i * doubles + k]);
  }
}

TEST_F(FilmTest, ShowsADamagedHeader) {
  // Every byte of the header counts: magic, version, layer, geometry, size, checksum.
  for (std::streamoff offset = 0; offset < 88; ++offset) {
    Create();
    Damage(offset);
    EXPECT_EQ(Film::Open(path_).status().code(), absl::StatusCode::kDataLoss) << offset;
  }
  Create();
  EXPECT_TRUE(Film::Open(path_).ok());
}

TEST_F(FilmTest, ShowsAFileOfAnotherLength) {
  Create();
  std::filesystem::resize_file(path_, std::filesystem::file_size(path_) - 4096);
  EXPECT_THAT(std::string(Film::Open(path_).status().message()), HasSubstr("bytes"));
  std::filesystem::resize_file(path_, 20);
  EXPECT_EQ(Film::Open(path_).status().code(), absl::StatusCode::kDataLoss);
  EXPECT_FALSE(Film::Open(directory_.path() / "none").ok());
}

TEST_F(FilmTest, SaysWhenThereIsNoRoom) {
  // 2^40 pixels take more than any disk has.
  const PixelRect huge = {0, 0, 1 << 20, 1 << 20};
  const auto film = Film::Create(path_, {FilmLayer::kPath, {huge, 1024}, LayoutOf(spec_)});
  EXPECT_EQ(film.status().code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(film.status().message()), HasSubstr(path_.string()));
  EXPECT_FALSE(std::filesystem::exists(path_));
}

TEST_F(FilmTest, ResultDigestCoversCountsMeansAndMoments) {
  const std::unique_ptr<Film> film = Create();
  MergeAll(*film, spec_);
  const Digest digest = film->ResultDigest();
  const PixelLayout layout = LayoutOf(spec_);
  double* values = const_cast<double*>(film->At(37, 34).values);
  for (const int k : {layout.Mean(7, 2), layout.M2(1), layout.M3(0), layout.Plain(2)}) {
    const double kept = values[k];
    values[k] = std::nextafter(kept, 2 * kept);
    EXPECT_NE(film->ResultDigest(), digest) << k;
    values[k] = kept;
  }
  PixelCounts& counts = const_cast<PixelCounts&>(*film->At(1, 2).counts);
  ++counts.nonfinite;
  EXPECT_NE(film->ResultDigest(), digest);
  --counts.nonfinite;
  EXPECT_EQ(film->ResultDigest(), digest);
}

}  // namespace
}  // namespace strata
