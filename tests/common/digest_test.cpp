// SHA-256 against the standard's own examples, and the text form of digests.

#include "common/digest.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace strata {
namespace {

// FIPS 180-4 examples: "abc", and 448 bits.
TEST(DigestTest, IsSha256) {
  EXPECT_EQ(DigestOf("abc").Hex(),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(DigestOf("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq").Hex(),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
}

TEST(DigestTest, DoesNotDependOnHowTheBytesAreFed) {
  Sha256 sha;
  sha.Update("a");
  sha.Update("");
  sha.Update("bc");
  EXPECT_EQ(sha.Finish(), DigestOf("abc"));
}

TEST(DigestTest, IsParsedInBothForms) {
  const Digest digest = DigestOf("abc");
  EXPECT_EQ(*Digest::Parse(digest.Hex()), digest);
  EXPECT_EQ(*Digest::Parse(digest.ToString()), digest);
  EXPECT_EQ(digest.ToString(), "sha256:" + digest.Hex());
  for (const std::string& bad : {std::string(), digest.Hex().substr(1), digest.Hex() + "0",
                                 std::string(64, 'g'), std::string(64, 'A')}) {
    EXPECT_EQ(Digest::Parse(bad).status().code(), absl::StatusCode::kInvalidArgument) << bad;
  }
}

TEST(DigestTest, OfAFileIsThatOfItsBytes) {
  std::string pattern = (std::filesystem::temp_directory_path() / "strata-test-XXXXXX").string();
  const std::filesystem::path directory = mkdtemp(pattern.data());
  const std::string content(3 << 20, 'z');  // More than one block of the reader.
  std::ofstream(directory / "file", std::ios::binary) << content;
  EXPECT_EQ(*DigestOfFile(directory / "file"), DigestOf(content));
  EXPECT_EQ(DigestOfFile(directory / "none").status().code(), absl::StatusCode::kNotFound);
  std::filesystem::remove_all(directory);
}

}  // namespace
}  // namespace strata
