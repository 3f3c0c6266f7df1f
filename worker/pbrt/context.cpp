#include "worker/pbrt/context.h"

#include <fstream>
#include <system_error>

#include "common/bundle.h"
#include "worker/pbrt/tokenizer.h"

namespace strata {

ReadContext::ReadContext(const FileSource& source, const std::string& scene_path)
    : source_(source),
      directory_(std::filesystem::path(scene_path).parent_path().generic_string()) {}

absl::StatusOr<std::string> ReadContext::AddFile(std::string_view name,
                                                 const SourceLocation& where) {
  STRATA_ASSIGN_OR_RETURN(std::string path, NameFile(name, where));
  STRATA_RETURN_IF_ERROR(AddNamedFile(path, where));
  return path;
}

absl::StatusOr<std::string> ReadContext::NameFile(std::string_view name,
                                                  const SourceLocation& where) const {
  absl::StatusOr<std::string> path = ResolveBundlePath(directory_, name);
  if (!path.ok()) return Annotate(path.status(), where.ToString());
  return path;
}

absl::Status ReadContext::AddNamedFile(const std::string& bundle_path,
                                       const SourceLocation& where) {
  STRATA_RETURN_IF_ERROR(Locate(bundle_path, where).status());
  files.insert(bundle_path);
  return absl::OkStatus();
}

absl::StatusOr<std::filesystem::path> ReadContext::Locate(const std::string& bundle_path,
                                                          const SourceLocation& where) const {
  absl::StatusOr<std::filesystem::path> path = source_.Locate(bundle_path);
  if (!path.ok()) return Annotate(path.status(), where.ToString());
  return path;
}

absl::StatusOr<std::string> ReadContext::ReadText(const std::string& bundle_path,
                                                  const SourceLocation& where) const {
  STRATA_ASSIGN_OR_RETURN(const std::filesystem::path path, Locate(bundle_path, where));
  absl::StatusOr<std::string> text = ReadWholeFile(path, uint64_t{4} << 30);
  if (!text.ok()) {
    return Annotate(text.status(), StrCat(where.ToString(), ": \"", bundle_path, "\""));
  }
  return text;
}

}  // namespace strata
