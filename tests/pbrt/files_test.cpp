// Where the files of a scene are found, and that none is read from outside its root.

#include <gtest/gtest.h>
#include <zlib.h>

#include <filesystem>

#include "common/bundle.h"
#include "tests/pbrt/scene_folder.h"

namespace strata {
namespace {

namespace fs = std::filesystem;

std::string Message(const absl::Status& status) { return std::string(status.message()); }

/// Of as many members as there are parts.
void WriteGzip(const SceneFolder& folder, const std::string& path,
               std::initializer_list<std::string_view> parts) {
  const std::string local = (folder.root() / path).string();
  const char* mode = "wb";
  for (const std::string_view part : parts) {
    gzFile file = gzopen(local.c_str(), mode);
    ASSERT_TRUE(file);
    gzwrite(file, part.data(), static_cast<unsigned>(part.size()));
    gzclose(file);
    mode = "ab";
  }
}

TEST(Files, MayBeCompressedByGzip) {
  const SceneFolder folder;
  folder.Write("scene.pbrt",
               "WorldBegin\nInclude \"part.pbrt.gz\"\n"
               "Shape \"plymesh\" \"string filename\" \"mesh.ply.gz\"\n");
  std::string spheres;
  for (int i = 0; i < 100000; ++i) spheres += "# Much that is alike is soon told.\n";
  WriteGzip(folder, "part.pbrt.gz", {spheres, "Shape \"sphere\"\n", "Shape \"sphere\"\n"});
  WriteGzip(folder, "mesh.ply.gz",
            {"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
             "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
             "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"});
  const auto scene = folder.Read();
  ASSERT_TRUE(scene.ok()) << scene.status();
  ASSERT_EQ(scene->scene.shapes.size(), 3u);
  EXPECT_EQ(std::get<TriangleMeshShape>(scene->scene.shapes[2].geometry).triangles.size(), 1u);

  // Cut short anywhere, and damaged.
  std::ifstream file(folder.root() / "part.pbrt.gz", std::ios::binary);
  const std::string whole((std::istreambuf_iterator<char>(file)), {});
  ASSERT_GT(whole.size(), 100u);
  for (const size_t size : {size_t{3}, size_t{11}, whole.size() / 2, whole.size() - 1}) {
    folder.Write("part.pbrt.gz", std::string_view(whole).substr(0, size));
    EXPECT_NE(folder.Read().status().message().find(
                  "the gzip file is damaged or cut short; compress it again"),
              std::string::npos)
        << size << ": " << folder.Read().status();
  }
  std::string damaged = whole;
  damaged[whole.size() / 2] ^= 0x55;
  folder.Write("part.pbrt.gz", damaged);
  EXPECT_FALSE(folder.Read().ok());
}

TEST(Files, MayBeginWithAByteOrderMark) {
  const auto scene = ReadText("\xef\xbb\xbfWorldBegin Shape \"sphere\"");
  ASSERT_TRUE(scene.ok()) << scene.status();
  EXPECT_EQ(scene->scene.shapes.size(), 1u);
}

TEST(BundlePath, IsRelativeAndPlain) {
  for (const char* path : {"scene.pbrt", "a/b.ply", "a b/c", ".hidden", "a..b"}) {
    EXPECT_TRUE(IsBundlePath(path)) << path;
  }
  for (const char* path : {"", "/a", "a/", "a//b", ".", "./a", "a/..", "../a", "a/../b", "a\nb"}) {
    EXPECT_FALSE(IsBundlePath(path)) << path;
  }
}

TEST(BundlePath, IsResolvedAgainstTheSceneFolder) {
  EXPECT_EQ(*ResolveBundlePath("", "a.ply"), "a.ply");
  EXPECT_EQ(*ResolveBundlePath("scenes/box", "./models/../a.ply"), "scenes/box/a.ply");
  EXPECT_EQ(*ResolveBundlePath("scenes/box", "../a.ply"), "scenes/a.ply");
  EXPECT_FALSE(ResolveBundlePath("scenes/box", "../../../a.ply").ok());
  EXPECT_FALSE(ResolveBundlePath("scenes", "/etc/passwd").ok());
  EXPECT_FALSE(ResolveBundlePath("scenes", "").ok());
  EXPECT_FALSE(ResolveBundlePath("scenes", "..").ok());
}

TEST(SceneFiles, AreListedOnceAndSorted) {
  SceneFolder folder;
  folder.Write("box/scene.pbrt",
               "Include \"parts/frame.pbrt\" WorldBegin Include \"parts/world.pbrt\" Include "
               "\"parts/world.pbrt\"");
  folder.Write("box/parts/frame.pbrt", "Film \"rgb\" \"integer xresolution\" 7");
  // Files are named relative to the main file's folder, wherever they are included from.
  folder.Write("box/parts/world.pbrt",
               "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]\n"
               "Material \"diffuse\" \"spectrum reflectance\" \"../gray.spd\"");
  folder.Write("gray.spd", "# gray\n360 0.5\n830 0.5\n");
  const absl::StatusOr<PbrtScene> scene = folder.Read("box/scene.pbrt");
  ASSERT_TRUE(scene.ok()) << scene.status();
  EXPECT_EQ(scene->files, (std::vector<std::string>{"box/parts/frame.pbrt", "box/parts/world.pbrt",
                                                    "box/scene.pbrt", "gray.spd"}));
  EXPECT_EQ(scene->scene.defaults.width, 7);
  EXPECT_EQ(scene->scene.shapes.size(), 2u);
}

TEST(SceneFiles, OutsideTheRootAreRefused) {
  SceneFolder folder;
  folder.Write("outside.pbrt", "WorldBegin");
  folder.Write("root/scene.pbrt", "Include \"../outside.pbrt\"");
  folder.Write("root/absolute.pbrt",
               "\nInclude \"" + (folder.root() / "outside.pbrt").string() + "\"");
  folder.Write("root/linked.pbrt", "\n\nInclude \"link.pbrt\"");
  fs::create_symlink("../outside.pbrt", folder.root() / "root/link.pbrt");
  fs::create_symlink("scene2.pbrt", folder.root() / "root/inner.pbrt");
  folder.Write("root/scene2.pbrt", "WorldBegin");
  const DirectorySource source(folder.root() / "root");

  EXPECT_EQ(Message(ReadPbrt(source, "scene.pbrt").status()).find("scene.pbrt:1: "), 0u);
  EXPECT_EQ(Message(ReadPbrt(source, "absolute.pbrt").status()).find("absolute.pbrt:2: "), 0u);
  const absl::Status linked = ReadPbrt(source, "linked.pbrt").status();
  EXPECT_EQ(linked.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(Message(linked).find("linked.pbrt:3: "), 0u) << linked;
  EXPECT_FALSE(ReadPbrt(source, "../outside.pbrt").ok());
  // A link that stays inside is as good as the file.
  EXPECT_TRUE(ReadPbrt(source, "inner.pbrt").ok());
}

TEST(SceneFiles, MissingOnesAreNotFound) {
  SceneFolder folder;
  folder.Write("scene.pbrt", "\nInclude \"gone.pbrt\"");
  folder.Write("folder/file", "");
  EXPECT_EQ(folder.Read("nothing.pbrt").status().code(), absl::StatusCode::kNotFound);
  const absl::Status status = folder.Read().status();
  EXPECT_EQ(status.code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(Message(status).find("scene.pbrt:2: "), 0u) << status;
  EXPECT_EQ(folder.Read("folder").status().code(), absl::StatusCode::kInvalidArgument);
}

TEST(SceneFiles, CyclesAreTold) {
  SceneFolder folder;
  folder.Write("self.pbrt", "WorldBegin\nInclude \"self.pbrt\"");
  EXPECT_EQ(Message(folder.Read("self.pbrt").status()),
            "self.pbrt:2: \"self.pbrt\" includes itself");
  folder.Write("a.pbrt", "Include \"b.pbrt\"");
  folder.Write("b.pbrt", "\nInclude \"./x/../a.pbrt\"");
  fs::create_directory(folder.root() / "x");
  EXPECT_EQ(Message(folder.Read("a.pbrt").status()), "b.pbrt:2: \"a.pbrt\" includes itself");
  folder.Write("c.pbrt", "WorldBegin Import \"d.pbrt\"");
  folder.Write("d.pbrt", "Import \"c.pbrt\"");
  EXPECT_EQ(Message(folder.Read("c.pbrt").status()), "d.pbrt:1: \"c.pbrt\" includes itself");
}

TEST(SceneFiles, DeepIncludesAreTold) {
  SceneFolder folder;
  for (int i = 0; i < 100; ++i) {
    folder.Write(std::to_string(i), "Include \"" + std::to_string(i + 1) + "\"");
  }
  folder.Write("100", "");
  EXPECT_NE(Message(folder.Read("0").status()).find("deep"), std::string::npos);
}

TEST(SceneFiles, WithNegativeSpectraAreTold) {
  SceneFolder folder;
  folder.Write("scene.pbrt", "WorldBegin LightSource \"point\" \"spectrum I\" \"lamp.spd\"");
  folder.Write("lamp.spd", "360 1\n830 -1\n");
  EXPECT_EQ(Message(folder.Read().status()),
            "lamp.spd:2: a spectrum holds the value -1; it must not be negative");
}

TEST(SceneFiles, ThatMultiplyAreTold) {
  SceneFolder folder;
  for (int i = 0; i < 30; ++i) {
    const std::string include = "Include \"" + std::to_string(i + 1) + "\"\n";
    folder.Write(std::to_string(i), include + include);
  }
  folder.Write("30", "");
  const std::string message = Message(folder.Read("0").status());
  EXPECT_NE(message.find("more than 100000 times"), std::string::npos) << message;
  EXPECT_NE(message.find(":1: "), std::string::npos) << message;
}

TEST(SceneFiles, AnImportedFileKeepsItsStateToItself) {
  SceneFolder folder;
  folder.Write("scene.pbrt", "WorldBegin Translate 1 0 0 Import \"part.pbrt\" Shape \"sphere\"");
  folder.Write("part.pbrt",
               "Translate 0 2 0 ReverseOrientation Shape \"sphere\"\n"
               "MakeNamedMaterial \"m\" \"string type\" \"interface\"");
  const absl::StatusOr<PbrtScene> scene = folder.Read();
  ASSERT_TRUE(scene.ok()) << scene.status();
  ASSERT_EQ(scene->scene.shapes.size(), 2u);
  EXPECT_EQ(scene->scene.shapes[0].to_world, Transform::Translate(1, 2, 0));
  EXPECT_TRUE(scene->scene.shapes[0].reverse_orientation);
  EXPECT_EQ(scene->scene.shapes[1].to_world, Transform::Translate(1, 0, 0));
  EXPECT_FALSE(scene->scene.shapes[1].reverse_orientation);

  folder.Write("part.pbrt", "\nAttributeBegin");
  EXPECT_EQ(Message(folder.Read().status()).find("part.pbrt:2: "), 0u);
  folder.Write("scene.pbrt", "WorldBegin AttributeBegin Import \"part.pbrt\" AttributeEnd");
  folder.Write("part.pbrt", "AttributeEnd");
  EXPECT_EQ(Message(folder.Read().status()).find("part.pbrt:1: "), 0u);
  folder.Write("part.pbrt", "Include \"inner.pbrt\"");
  folder.Write("inner.pbrt", "\nAttributeEnd");
  EXPECT_EQ(Message(folder.Read().status()), "inner.pbrt:2: AttributeEnd without AttributeBegin");
  // What the imported file has opened itself may be closed by what it includes.
  folder.Write("part.pbrt", "AttributeBegin Include \"inner.pbrt\"");
  EXPECT_TRUE(folder.Read().ok());
}

TEST(Bundles, NameTheirContent) {
  SceneFolder folder;
  folder.Write("scene.pbrt", "WorldBegin");
  folder.Write("a.ply", "one");
  const DirectorySource source(folder.root());
  const absl::StatusOr<Bundle> bundle = MakeBundle(source, "scene.pbrt", {"scene.pbrt", "a.ply"});
  ASSERT_TRUE(bundle.ok()) << bundle.status();
  ASSERT_EQ(bundle->files.size(), 2u);
  EXPECT_EQ(bundle->files[0].path, "a.ply");
  EXPECT_EQ(bundle->files[0].bytes, 3u);
  EXPECT_EQ(bundle->files[0].digest, DigestOf("one"));

  const Digest digest = BundleDigest(*bundle);
  folder.Write("a.ply", "two");
  EXPECT_NE(BundleDigest(*MakeBundle(source, "scene.pbrt", {"a.ply", "scene.pbrt"})), digest);
  folder.Write("a.ply", "one");
  EXPECT_EQ(BundleDigest(*MakeBundle(source, "scene.pbrt", {"a.ply", "scene.pbrt"})), digest);
  // Another main file of the same files is another scene.
  EXPECT_NE(BundleDigest(*MakeBundle(source, "a.ply", {"a.ply", "scene.pbrt"})), digest);
  EXPECT_FALSE(MakeBundle(source, "scene.pbrt", {"gone", "scene.pbrt"}).ok());
}

TEST(Bundles, AreCheckedAtTheEdge) {
  Bundle bundle{"b", {{"a", {}, 1}, {"b", {}, 2}}};
  EXPECT_TRUE(ValidateBundle(bundle).ok());
  std::swap(bundle.files[0], bundle.files[1]);
  EXPECT_FALSE(ValidateBundle(bundle).ok());
  EXPECT_FALSE(ValidateBundle({"b", {{"b", {}, 1}, {"b", {}, 1}}}).ok());
  EXPECT_FALSE(ValidateBundle({"c", {{"a", {}, 1}}}).ok());
  EXPECT_FALSE(ValidateBundle({"", {}}).ok());
  EXPECT_FALSE(ValidateBundle({"../b", {{"../b", {}, 1}}}).ok());
  EXPECT_FALSE(ValidateBundle({"/b", {{"/b", {}, 1}}}).ok());
}

}  // namespace
}  // namespace strata
