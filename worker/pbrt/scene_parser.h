#pragma once

#include <absl/container/flat_hash_map.h>

#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "worker/pbrt/animated_transform.h"
#include "worker/pbrt/context.h"
#include "worker/pbrt/entities.h"
#include "worker/pbrt/parameters.h"
#include "worker/pbrt/tokenizer.h"

namespace strata {

/// Carries out the directives of a pbrt-v4 file, one after the other, on the scene of a context.
class SceneParser {
 public:
  explicit SceneParser(ReadContext& context);

  /// Reads the file and all it includes.
  absl::Status ParseFile(const std::string& bundle_path);

 private:
  /// What AttributeBegin keeps and AttributeEnd brings back.
  struct GraphicsState {
    AnimatedTransform ctm;  ///< World from the current space; camera space before WorldBegin.
    bool at_start = true, at_end = true;  ///< Which of both directives change (ActiveTransform).
    bool reverse_orientation = false;
    MaterialId material = 0;
    MediumBorder media;  ///< Of MediumInterface.
    std::optional<AreaLight> area_light;
    std::string color_space = "srgb";
    /// Of Attribute directives, by target ("shape", "light", ...). Shared, as it rarely changes.
    std::shared_ptr<const absl::flat_hash_map<std::string, std::vector<Parameter>>> attributes;
  };
  enum class ScopeKind { kAttribute, kTransform, kObject };
  struct Scope {
    ScopeKind kind;
    SourceLocation where;
    GraphicsState state;
  };
  /// A file that is being read; an imported one has its own graphics state.
  struct OpenFile {
    std::string bundle_path;
    std::unique_ptr<Tokenizer> tokens;
    SourceLocation included_at;
    size_t scopes = 0;  ///< Open when the file began.
    std::optional<GraphicsState> state_after;
  };
  enum class Block { kOptions, kWorld, kEither };
  struct Directive {
    Block block;
    absl::Status (SceneParser::*run)();
  };
  static const absl::flat_hash_map<std::string_view, Directive>& Directives();

  // ---- files ----
  absl::Status Open(const std::string& bundle_path, const SourceLocation& where, bool import);
  absl::Status CloseFile();
  absl::Status RunDirective(const Token& token);
  absl::Status Finish();
  /// Borders of media do not emit, as in pbrt, and have no masks. Materials may be defined after
  /// their use.
  void StripInterfaces();

  // ---- what directives read of the current file ----
  Tokenizer& tokens() { return *files_.back().tokens; }
  const SourceLocation& Here() const { return directive_at_; }
  absl::StatusOr<std::string> ReadString();
  /// `count` numbers, which may stand in brackets.
  absl::Status ReadNumbers(double* values, int count);
  /// The parameters that follow, with those of Attribute directives for `target`.
  absl::StatusOr<ParameterReader> ReadParameters(std::string_view name,
                                                 std::string_view target = "");
  /// The same for a directive of a type, both put into pbrt-v4's words if they are in pbrt-v3's.
  absl::StatusOr<ParameterReader> ReadTyped(std::string* type, std::string_view target = "");
  ParameterReader WithInherited(std::string_view name, std::vector<Parameter> own,
                                std::string_view target) const;

  // ---- directives, by their names in the file ----
  absl::Status Include();
  absl::Status Import();
  absl::Status WorldBegin();
  absl::Status WorldEnd();
  absl::Status AttributeBegin();
  absl::Status AttributeEnd();
  absl::Status TransformBegin();
  absl::Status TransformEnd();
  absl::Status ObjectBegin();
  absl::Status ObjectEnd();
  absl::Status ObjectInstance();
  absl::Status Attribute();
  absl::Status ReverseOrientation();
  absl::Status ColorSpace();
  absl::Status Option();

  absl::Status Identity();
  absl::Status Translate();
  absl::Status Scale();
  absl::Status Rotate();
  absl::Status LookAt();
  absl::Status SetTransform();
  absl::Status ConcatTransform();
  absl::Status CoordinateSystem();
  absl::Status CoordSysTransform();
  absl::Status TransformTimes();
  absl::Status ActiveTransform();

  absl::Status Camera();
  absl::Status Film();
  absl::Status PixelFilter();
  absl::Status Sampler();
  absl::Status Integrator();
  absl::Status Accelerator();

  absl::Status Texture();
  absl::Status Material();
  absl::Status MakeNamedMaterial();
  absl::Status NamedMaterial();
  absl::Status LightSource();
  absl::Status AreaLightSource();
  absl::Status MakeNamedMedium();
  absl::Status MediumInterface();
  absl::Status Shape();

  absl::Status OpenScope(ScopeKind kind);
  absl::Status CloseScope(ScopeKind kind, std::string_view begin);
  /// How many scopes were open when the innermost import began: neither the imported file nor what
  /// it includes may close them.
  size_t ScopesAroundImport() const;
  absl::Status PlaceEmission(ShapeDescription& shape);
  int32_t ObjectNamed(const std::string& name);
  absl::Status Concatenate(const Transform& transform);
  /// Replaces the current transform where it is active.
  void Replace(const AnimatedTransform& transform);
  /// Warns if the current transform moves, where `what` keeps that of the start.
  void WarnOfMotion(std::string_view what);
  /// The shapes of an object that is placed once, by the current transform, which moves.
  std::vector<ShapeDescription>& MovingShapes();
  absl::Status PlaceShutter();

  ReadContext& context_;
  TextureTable textures_;
  MaterialTable materials_;
  MediumTable media_;

  std::vector<OpenFile> files_;
  size_t inclusions_ = 0;  ///< Files opened so far, each as often as it was.
  SourceLocation directive_at_;
  std::string directive_;

  bool in_world_ = false;
  GraphicsState state_;
  std::vector<Scope> scopes_;
  absl::flat_hash_map<std::string, AnimatedTransform> coordinate_systems_;
  double motion_start_ = 0, motion_end_ = 1;  ///< TransformTimes.
  std::optional<size_t> moving_instance_;     ///< The last one that MovingShapes has made.

  struct ObjectState {
    bool defined = false;
    SourceLocation first_use;
  };
  std::vector<ObjectState> object_states_;  ///< Of each object of the scene.
  absl::flat_hash_map<std::string, int32_t> objects_;
  std::optional<int32_t> open_object_;
};

}  // namespace strata
