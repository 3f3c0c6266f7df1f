#include "worker/pbrt/context.h"

#include <fstream>
#include <system_error>

#include "common/bundle.h"
#include "worker/pbrt/tokenizer.h"

namespace strata {

void WarningList::Add(const SourceLocation& where, std::string_view text) {
  const auto [it, is_new] = index_.try_emplace(std::string(text), entries_.size());
  if (is_new) entries_.push_back({{where, std::string(text)}, 0});
  ++entries_[it->second].count;
}

std::vector<SceneWarning> WarningList::Take() {
  std::vector<SceneWarning> warnings;
  for (Entry& entry : entries_) {
    if (entry.count > 1) absl::StrAppend(&entry.warning.text, " (", entry.count, " times)");
    warnings.push_back(std::move(entry.warning));
  }
  entries_.clear();
  index_.clear();
  return warnings;
}

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

absl::StatusOr<std::string> ReadWholeFile(const std::filesystem::path& path, uint64_t limit) {
  std::error_code error;
  const uint64_t bytes = std::filesystem::file_size(path, error);
  if (error) return absl::NotFoundError(error.message());
  if (bytes > limit) {
    return absl::InvalidArgumentError(
        StrCat("the file has ", bytes, " bytes; at most ", limit, " are read"));
  }
  std::string text(bytes, '\0');
  std::ifstream file(path, std::ios::binary);
  if (!file.read(text.data(), static_cast<std::streamsize>(bytes))) {
    return absl::UnavailableError("the file cannot be read; check its permissions");
  }
  return text;
}

}  // namespace strata
