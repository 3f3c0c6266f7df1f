#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/status.h"
#include "worker/math/vec.h"
#include "worker/pbrt/context.h"
#include "worker/pbrt/tokenizer.h"
#include "worker/scene/description.h"

namespace strata {

/// One typed parameter of a directive: "float fov" [ 35 ].
struct Parameter {
  std::string type, name;
  SourceLocation where;
  std::vector<double> numbers;       ///< Numeric types, and spectra given as numbers.
  std::vector<std::string> strings;  ///< "string", "texture", and spectra given by name.
  std::vector<bool> bools;
  bool used = false;
};

/// Reads the parameters that follow a directive, up to the next one. INVALID_ARGUMENT for an
/// unknown type, values of another type or of the wrong count, and names given twice.
absl::StatusOr<std::vector<Parameter>> ParseParameters(Tokenizer& tokens);

/// The parameters of one directive, asked for by name and type. Getters return the value, or
/// `fallback` when there is none; a parameter of another type is an error. The first error is kept
/// and told by Finish, so that a reader may ask for all it needs and check once.
class ParameterReader {
 public:
  /// `directive` as messages name it: `Shape "sphere"`. `inherited` are those of Attribute
  /// directives, which yield to `own` ones of the same name and need not be used.
  ParameterReader(std::string directive, SourceLocation where, std::vector<Parameter> own,
                  const std::vector<Parameter>& inherited = {});

  bool Has(std::string_view name) const { return Find(name) != nullptr; }
  double Float(std::string_view name, double fallback);
  int Integer(std::string_view name, int fallback);
  bool Bool(std::string_view name, bool fallback);
  std::string String(std::string_view name, std::string_view fallback);
  std::optional<Vec3f> Point3(std::string_view name);
  std::vector<double> Floats(std::string_view name);
  std::vector<int> Integers(std::string_view name);
  std::vector<std::string> Strings(std::string_view name);
  std::vector<Vec2f> Point2s(std::string_view name);
  std::vector<Vec3f> Point3s(std::string_view name);
  std::vector<Vec3f> Normals(std::string_view name);

  /// The parameter of whatever type, marked as used; null when there is none.
  const Parameter* Take(std::string_view name);
  /// Marks a parameter as known that changes nothing in this renderer.
  void Ignore(std::string_view name) { Take(name); }
  /// Marks all as known, for a directive that is left out as a whole.
  void IgnoreAll();

  /// Keeps the first error.
  void Fail(const absl::Status& status) { status_.Update(status); }
  void Fail(const SourceLocation& at, std::string_view what) { Fail(ErrorAt(at, what)); }
  bool ok() const { return status_.ok(); }

  /// The first error; otherwise warns of each parameter nobody asked for.
  absl::Status Finish(WarningList& warnings) const;

  const std::string& directive() const { return directive_; }
  const SourceLocation& where() const { return where_; }

 private:
  const Parameter* Find(std::string_view name) const;
  /// The parameter if it is of one of `types` and, unless count is 0, has `count` numbers.
  const Parameter* Typed(std::string_view name, std::initializer_list<std::string_view> types,
                         size_t count);

  std::string directive_;
  SourceLocation where_;
  std::vector<Parameter> parameters_;
  size_t own_count_ = 0;  ///< The first ones; what follows is inherited.
  absl::Status status_;
};

}  // namespace strata
