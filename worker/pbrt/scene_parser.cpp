#include "worker/pbrt/scene_parser.h"

#include <algorithm>
#include <utility>

#include "worker/pbrt/version3.h"
#include "worker/scene/references.h"

// Files, scopes and the directives that change the graphics state alone. What describes things is
// in entity_directives.cpp.

namespace strata {
namespace {

/// Deeper than any real scene, and shallow enough that states and files stay small.
constexpr size_t kMaxScopes = 4096, kMaxOpenFiles = 64;
/// In all. Files that each include the next one twice would be read 2^64 times before they are too
/// deep; the largest scenes have some thousands.
constexpr size_t kMaxInclusions = 100'000;

}  // namespace

SceneParser::SceneParser(ReadContext& context)
    : context_(context), textures_(context), materials_(context, textures_), media_(context) {
  // pbrt-v4's defaults of what need not be said.
  context.scene.defaults.filter = DefaultFilter(FilterKind::kGaussian);
}

const absl::flat_hash_map<std::string_view, SceneParser::Directive>& SceneParser::Directives() {
  using P = SceneParser;
  static const auto* directives = new absl::flat_hash_map<std::string_view, Directive>{
      {"Include", {Block::kEither, &P::Include}},
      {"Import", {Block::kWorld, &P::Import}},
      {"WorldBegin", {Block::kOptions, &P::WorldBegin}},
      {"WorldEnd", {Block::kWorld, &P::WorldEnd}},
      {"AttributeBegin", {Block::kWorld, &P::AttributeBegin}},
      {"AttributeEnd", {Block::kWorld, &P::AttributeEnd}},
      {"TransformBegin", {Block::kEither, &P::TransformBegin}},
      {"TransformEnd", {Block::kEither, &P::TransformEnd}},
      {"ObjectBegin", {Block::kWorld, &P::ObjectBegin}},
      {"ObjectEnd", {Block::kWorld, &P::ObjectEnd}},
      {"ObjectInstance", {Block::kWorld, &P::ObjectInstance}},
      {"Attribute", {Block::kEither, &P::Attribute}},
      {"ReverseOrientation", {Block::kWorld, &P::ReverseOrientation}},
      {"ColorSpace", {Block::kEither, &P::ColorSpace}},
      {"Option", {Block::kOptions, &P::Option}},
      {"Identity", {Block::kEither, &P::Identity}},
      {"Translate", {Block::kEither, &P::Translate}},
      {"Scale", {Block::kEither, &P::Scale}},
      {"Rotate", {Block::kEither, &P::Rotate}},
      {"LookAt", {Block::kEither, &P::LookAt}},
      {"Transform", {Block::kEither, &P::SetTransform}},
      {"ConcatTransform", {Block::kEither, &P::ConcatTransform}},
      {"CoordinateSystem", {Block::kEither, &P::CoordinateSystem}},
      {"CoordSysTransform", {Block::kEither, &P::CoordSysTransform}},
      {"TransformTimes", {Block::kOptions, &P::TransformTimes}},
      {"ActiveTransform", {Block::kEither, &P::ActiveTransform}},
      {"Camera", {Block::kOptions, &P::Camera}},
      {"Film", {Block::kOptions, &P::Film}},
      {"PixelFilter", {Block::kOptions, &P::PixelFilter}},
      {"Sampler", {Block::kOptions, &P::Sampler}},
      {"Integrator", {Block::kOptions, &P::Integrator}},
      {"Accelerator", {Block::kOptions, &P::Accelerator}},
      {"Texture", {Block::kWorld, &P::Texture}},
      {"Material", {Block::kWorld, &P::Material}},
      {"MakeNamedMaterial", {Block::kWorld, &P::MakeNamedMaterial}},
      {"NamedMaterial", {Block::kWorld, &P::NamedMaterial}},
      {"LightSource", {Block::kWorld, &P::LightSource}},
      {"AreaLightSource", {Block::kWorld, &P::AreaLightSource}},
      {"MakeNamedMedium", {Block::kEither, &P::MakeNamedMedium}},
      {"MediumInterface", {Block::kEither, &P::MediumInterface}},
      {"Shape", {Block::kWorld, &P::Shape}},
  };
  return *directives;
}

// ---- files ----

absl::Status SceneParser::ParseFile(const std::string& bundle_path) {
  STRATA_RETURN_IF_ERROR(Open(bundle_path, {bundle_path, 0}, false));
  while (!files_.empty()) {
    STRATA_ASSIGN_OR_RETURN(const Token token, tokens().Next());
    if (token.kind == Token::Kind::kEnd) {
      STRATA_RETURN_IF_ERROR(CloseFile());
    } else {
      STRATA_RETURN_IF_ERROR(RunDirective(token));
    }
  }
  directive_at_ = {bundle_path, std::max(directive_at_.line, 1)};
  return Finish();
}

absl::Status SceneParser::Open(const std::string& bundle_path, const SourceLocation& where,
                               bool import) {
  for (const OpenFile& file : files_) {
    if (file.bundle_path == bundle_path) {
      return ErrorAt(where, StrCat("\"", bundle_path, "\" includes itself"));
    }
  }
  if (files_.size() >= kMaxOpenFiles) {
    return ErrorAt(where, StrCat("files are included more than ", kMaxOpenFiles, " deep"));
  }
  if (++inclusions_ > kMaxInclusions) {
    return ErrorAt(where, StrCat("files are included more than ", kMaxInclusions,
                                 " times in all; define an object once and instance it"));
  }
  STRATA_ASSIGN_OR_RETURN(std::string text, context_.ReadText(bundle_path, where));
  OpenFile file;
  file.bundle_path = bundle_path;
  file.tokens = std::make_unique<Tokenizer>(bundle_path, std::move(text));
  file.included_at = where;
  file.scopes = scopes_.size();
  if (import) file.state_after = state_;
  files_.push_back(std::move(file));
  return absl::OkStatus();
}

absl::Status SceneParser::CloseFile() {
  OpenFile& file = files_.back();
  if (file.state_after) {
    if (scopes_.size() > file.scopes) {
      return ErrorAt(scopes_.back().where, "what begins here does not end in the imported file");
    }
    state_ = *std::move(file.state_after);
  }
  files_.pop_back();
  return absl::OkStatus();
}

absl::Status SceneParser::RunDirective(const Token& token) {
  directive_at_ = tokens().At(token.line);
  const auto it =
      token.kind == Token::Kind::kWord
          ? Directives().find(DirectiveOfVersion3(token.text, Here(), &context_.warnings))
          : Directives().end();
  if (it == Directives().end()) {
    std::string shown(token.text.substr(0, 40));
    std::replace_if(
        shown.begin(), shown.end(), [](unsigned char c) { return c < 0x20 || c >= 0x7f; }, '?');
    return ErrorAt(Here(), StrCat("\"", shown, "\" is no directive of pbrt-v4"));
  }
  directive_ = it->first;
  if (it->second.block == Block::kWorld && !in_world_) {
    return ErrorAt(Here(), StrCat(directive_, " must come after WorldBegin"));
  }
  if (it->second.block == Block::kOptions && in_world_) {
    return ErrorAt(Here(), StrCat(directive_, " must come before WorldBegin"));
  }
  return (this->*it->second.run)();
}

absl::Status SceneParser::Finish() {
  if (!scopes_.empty()) {
    return ErrorAt(scopes_.back().where, "what begins here never ends; add the matching End");
  }
  if (!in_world_) {
    return ErrorAt(Here(), "the file has no WorldBegin, and so no scene");
  }
  for (size_t i = 0; i < object_states_.size(); ++i) {
    if (object_states_[i].defined) continue;
    return ErrorAt(object_states_[i].first_use,
                   StrCat("there is no object \"", context_.scene.objects[i].name,
                          "\"; define it with ObjectBegin"));
  }
  STRATA_RETURN_IF_ERROR(textures_.CheckAllDefined());
  STRATA_RETURN_IF_ERROR(materials_.CheckAllDefined());
  STRATA_RETURN_IF_ERROR(media_.CheckAllDefined());
  StripInterfaces();
  return PlaceShutter();
}

void SceneParser::StripInterfaces() {
  ForEachShape(&context_.scene, [&](ShapeDescription& shape) {
    if (!std::holds_alternative<InterfaceMaterial>(context_.scene.materials[shape.material]))
      return;
    if (shape.emission)
      context_.Warn(shape.where, "a shape of \"interface\" material does not emit light");
    if (shape.border && shape.alpha != AlphaMask())
      context_.Warn(shape.where, "the \"alpha\" of a shape of \"interface\" material is ignored");
    shape.emission.reset();
    shape.alpha = {};
  });
}

absl::Status SceneParser::Include() {
  STRATA_ASSIGN_OR_RETURN(const std::string name, ReadString());
  STRATA_ASSIGN_OR_RETURN(const std::string path, context_.AddFile(name, Here()));
  return Open(path, Here(), false);
}

absl::Status SceneParser::Import() {
  STRATA_ASSIGN_OR_RETURN(const std::string name, ReadString());
  STRATA_ASSIGN_OR_RETURN(const std::string path, context_.AddFile(name, Here()));
  return Open(path, Here(), true);
}

// ---- reading of arguments ----

absl::StatusOr<std::string> SceneParser::ReadString() {
  STRATA_ASSIGN_OR_RETURN(const Token token, tokens().Next());
  if (token.kind != Token::Kind::kString) {
    return ErrorAt(Here(), StrCat(directive_, " wants a string in quotes"));
  }
  return Unescape(token.text, tokens().At(token.line));
}

absl::Status SceneParser::ReadNumbers(double* values, int count) {
  STRATA_ASSIGN_OR_RETURN(Token token, tokens().Peek());
  const bool bracketed = token.kind == Token::Kind::kOpen;
  if (bracketed) STRATA_RETURN_IF_ERROR(tokens().Next().status());
  for (int i = 0; i < count; ++i) {
    STRATA_ASSIGN_OR_RETURN(token, tokens().Next());
    if (token.kind != Token::Kind::kWord) {
      return ErrorAt(Here(), StrCat(directive_, " wants ", count, " numbers"));
    }
    STRATA_ASSIGN_OR_RETURN(values[i], ParseNumber(token.text, tokens().At(token.line)));
  }
  if (!bracketed) return absl::OkStatus();
  STRATA_ASSIGN_OR_RETURN(token, tokens().Next());
  if (token.kind == Token::Kind::kClose) return absl::OkStatus();
  return ErrorAt(Here(), StrCat(directive_, " wants ", count, " numbers and a ]"));
}

absl::StatusOr<ParameterReader> SceneParser::ReadParameters(std::string_view name,
                                                            std::string_view target) {
  STRATA_ASSIGN_OR_RETURN(std::vector<Parameter> own, ParseParameters(tokens()));
  return WithInherited(name, std::move(own), target);
}

absl::StatusOr<ParameterReader> SceneParser::ReadTyped(std::string* type, std::string_view target) {
  STRATA_ASSIGN_OR_RETURN(std::vector<Parameter> own, ParseParameters(tokens()));
  STRATA_RETURN_IF_ERROR(TranslateVersion3(directive_, Here(), type, &own, &context_.warnings));
  return WithInherited(*type, std::move(own), target);
}

ParameterReader SceneParser::WithInherited(std::string_view name, std::vector<Parameter> own,
                                           std::string_view target) const {
  std::vector<Parameter> inherited;
  if (state_.attributes && !target.empty()) {
    const auto it = state_.attributes->find(ToAbsl(target));
    if (it != state_.attributes->end()) inherited = it->second;
  }
  return ParameterReader(StrCat(directive_, " \"", name.substr(0, 40), "\""), directive_at_,
                         std::move(own), inherited);
}

// ---- scopes ----

absl::Status SceneParser::WorldBegin() {
  if (!scopes_.empty()) {
    return ErrorAt(scopes_.back().where, "what begins here must end before WorldBegin");
  }
  in_world_ = true;
  state_.ctm = {};
  state_.at_start = state_.at_end = true;
  coordinate_systems_["world"] = {};
  return absl::OkStatus();
}

absl::Status SceneParser::WorldEnd() {
  context_.Warn(Here(), "pbrt-v3's WorldEnd is read as the end of the file");
  STRATA_ASSIGN_OR_RETURN(const Token token, tokens().Peek());
  if (token.kind == Token::Kind::kEnd) return absl::OkStatus();
  return ErrorAt(Here(), "WorldEnd must be the last of the file; what follows is another frame");
}

absl::Status SceneParser::OpenScope(ScopeKind kind) {
  if (scopes_.size() >= kMaxScopes) {
    return ErrorAt(Here(), StrCat("scopes are nested more than ", kMaxScopes, " deep"));
  }
  scopes_.push_back({kind, Here(), state_});
  return absl::OkStatus();
}

size_t SceneParser::ScopesAroundImport() const {
  const auto import = std::find_if(files_.rbegin(), files_.rend(), [](const OpenFile& file) {
    return file.state_after.has_value();
  });
  return import == files_.rend() ? 0 : import->scopes;
}

absl::Status SceneParser::CloseScope(ScopeKind kind, std::string_view begin) {
  if (scopes_.size() <= ScopesAroundImport()) {
    return ErrorAt(Here(), StrCat(directive_, " without ", begin));
  }
  if (scopes_.back().kind != kind) {
    return ErrorAt(Here(), StrCat(directive_, " does not match what begins at ",
                                  scopes_.back().where.ToString()));
  }
  if (kind == ScopeKind::kTransform) {
    const GraphicsState& before = scopes_.back().state;
    state_.ctm = before.ctm;
    state_.at_start = before.at_start;
    state_.at_end = before.at_end;
  } else {
    state_ = std::move(scopes_.back().state);
  }
  scopes_.pop_back();
  return absl::OkStatus();
}

absl::Status SceneParser::AttributeBegin() { return OpenScope(ScopeKind::kAttribute); }
absl::Status SceneParser::AttributeEnd() {
  return CloseScope(ScopeKind::kAttribute, "AttributeBegin");
}
absl::Status SceneParser::TransformBegin() { return OpenScope(ScopeKind::kTransform); }
absl::Status SceneParser::TransformEnd() {
  return CloseScope(ScopeKind::kTransform, "TransformBegin");
}

absl::Status SceneParser::Attribute() {
  STRATA_ASSIGN_OR_RETURN(const std::string target, ReadString());
  constexpr std::string_view kTargets[] = {"shape", "light", "material", "medium", "texture"};
  if (std::find(std::begin(kTargets), std::end(kTargets), target) == std::end(kTargets)) {
    return ErrorAt(Here(), StrCat("Attribute wants shape, light, material, medium or "
                                  "texture, not \"",
                                  target, "\""));
  }
  STRATA_ASSIGN_OR_RETURN(std::vector<Parameter> parameters, ParseParameters(tokens()));
  auto attributes =
      state_.attributes
          ? std::make_shared<absl::flat_hash_map<std::string, std::vector<Parameter>>>(
                *state_.attributes)
          : std::make_shared<absl::flat_hash_map<std::string, std::vector<Parameter>>>();
  std::vector<Parameter>& list = (*attributes)[target];
  for (Parameter& parameter : parameters) {
    const auto same = std::find_if(list.begin(), list.end(), [&](const Parameter& other) {
      return other.name == parameter.name;
    });
    if (same == list.end()) {
      list.push_back(std::move(parameter));
    } else {
      *same = std::move(parameter);
    }
  }
  state_.attributes = std::move(attributes);
  return absl::OkStatus();
}

absl::Status SceneParser::ReverseOrientation() {
  state_.reverse_orientation = !state_.reverse_orientation;
  return absl::OkStatus();
}

absl::Status SceneParser::ColorSpace() {
  STRATA_ASSIGN_OR_RETURN(const std::string name, ReadString());
  const auto known = ToRec709(name);
  if (!known.ok()) return Annotate(known.status(), Here().ToString());
  state_.color_space = name;
  return absl::OkStatus();
}

absl::Status SceneParser::Option() {
  STRATA_ASSIGN_OR_RETURN(const std::string name, ReadString());
  // One value, which pbrt-v4 takes without brackets.
  STRATA_ASSIGN_OR_RETURN(Token value, tokens().Next());
  if (value.kind == Token::Kind::kOpen) {
    STRATA_ASSIGN_OR_RETURN(value, tokens().Next());
    STRATA_ASSIGN_OR_RETURN(const Token close, tokens().Next());
    if (close.kind != Token::Kind::kClose) value.kind = Token::Kind::kEnd;
  }
  if (value.kind != Token::Kind::kWord && value.kind != Token::Kind::kString)
    return ErrorAt(Here(), StrCat("Option \"", name, "\" wants one value"));
  context_.Warn(Here(), "Option directives are ignored");
  return absl::OkStatus();
}

}  // namespace strata
