// Implements the commands by which scripts query the state as JSON and set fields by name.
#include <array>

#include "editor/commands/rows.hpp"
#include "editor/document/value_json.hpp"
#include "editor/session/scene_changes.hpp"
#include "runtime/frame/frame_settings.hpp"
#include "runtime/spec/numbers.hpp"

namespace lambent::editor {

namespace {

using nlohmann::json;

Result<scene::Value> readValue(const scene::FieldInfo& field, Words words) {
  using Kind = scene::ValueKind;
  if (field.kind == Kind::Text) return wordAt(words, 0);
  if (field.kind == Kind::Word) return scene::Word{wordAt(words, 0)};
  if (field.kind == Kind::Flag && words.size() == 1 && (words[0] == "true" || words[0] == "false"))
    return words[0] == "true";
  std::vector<float> n;
  for (const std::string& word : words)
    if (const auto number = spec::parseNumber(word)) n.push_back(*number);
  if (n.size() == words.size()) {
    if (field.kind == Kind::Whole && n.size() == 1) return static_cast<std::int32_t>(n[0]);
    if (field.kind == Kind::Number && n.size() == 1) return n[0];
    if (field.kind == Kind::Vector && n.size() == 3) return glm::vec3(n[0], n[1], n[2]);
    if (field.kind == Kind::Rotation && n.size() == 4) return glm::quat(n[3], n[0], n[1], n[2]);
  }
  constexpr std::array kWanted = {"give true or false",  // in the order of ValueKind
                                  "give a whole number", "give a number", "give three numbers",
                                  "give x, y, z and w"};
  return fail(std::string(field.name), fmt::format("\"{}\" is no value of it", fmt::join(words, " ")),
              kWanted[static_cast<std::size_t>(field.kind)]);
}

// Takes "Light.strength", a field of the selection, or "ball:Light.strength", a field of a named entity.
struct FieldPlace {
  std::vector<ecs::Entity> entities;
  const scene::FieldInfo* field = nullptr;
};
Result<FieldPlace> fieldPlaceOf(Session& session, const std::string& word) {
  FieldPlace place;
  const std::size_t colon = word.rfind(':'), dot = word.rfind('.');
  if (dot == std::string::npos)
    return fail(word, "is no field", "give COMPONENT.FIELD or NAME:COMPONENT.FIELD");
  const std::size_t begin = colon == std::string::npos ? 0 : colon + 1;
  if (colon == std::string::npos) {
    place.entities = session.selection.entities(session.document);
    if (place.entities.empty())
      return fail(word, "nothing is selected", "select first, or give NAME:COMPONENT.FIELD");
  } else {
    const auto found = findEntities(session, word.substr(0, colon));
    if (!found) return failAgain(found.error());
    place.entities = *found;
  }
  const auto field = scene::findField(word.substr(begin, dot - begin), word.substr(dot + 1));
  if (!field) return failAgain(field.error());
  place.field = *field;
  return place;
}

Result<void> set(Session& session, Words words) {
  const auto place = fieldPlaceOf(session, words[0]);
  if (!place) return failAgain(place.error());
  const auto value = readValue(*place->field, words.subspan(1));
  if (!value) return failAgain(value.error());
  std::vector<FieldEdit> edits;
  for (const ecs::Entity entity : place->entities)
    edits.push_back({entity, place->field->component, place->field->name, *value});
  return session.history.setFields(edits);
}

Answer get(Session& session, Words words) {
  const auto place = fieldPlaceOf(session, words[0]);
  if (!place) return failAgain(place.error());
  const ecs::Entity entity = place->entities.back();
  const scene::ComponentInfo* component = scene::findComponent(place->field->component);
  if (!component->has(session.document.registry(), entity))
    return fail(words[0], session.document.nameOf(entity) + " has no " + std::string(component->name));
  return valueJson(place->field->get(session.document.registry(), entity)).map([](const Json& value) {
    return json(value);
  });
}

json jobJson(const baker::JobState& job) {
  json to = {{"phase", baker::phaseName(job.phase)},
             {"fraction", job.fraction},
             {"seconds", job.seconds},
             {"upToDate", job.up_to_date}};
  if (job.reached) to["reached"] = baker::previewLevelName(*job.reached);
  if (job.error) to["error"] = job.error->line();
  if (job.report) to["rays"] = job.report->rays;
  return to;
}

json handlesJson(const Session& session) {
  const GizmoOptions& options = session.handles.gizmo.options;
  return {{"shown", session.handles.shown},
          {"mode", kModes[static_cast<std::size_t>(options.mode)]},
          {"local", options.space == GizmoSpace::Local},
          {"snap", options.snap},
          {"steps", {options.snap_m, options.snap_deg, options.snap_scale}}};
}

Answer state(Session& session) {
  json scenes = json::array();
  for (std::size_t i = 0; i < session.scenes.entries().size(); ++i) {
    const SceneEntry& entry = session.scenes.entries()[i];
    json row = {{"id", entry.id},
                {"source", entry.source.string()},
                {"bundle", entry.bundle.string()},
                {"shown", entry.shown.string()},
                {"open", entry.slot.has_value()},
                {"bakeOptions", entry.options.settings()},
                {"needsRebake", session.changes.needsRebake(i)},
                {"status", statusOf(session, i).text}};
    if (const auto job = session.scenes.jobOf(i)) row["bake"] = jobJson(*job);
    scenes.push_back(std::move(row));
  }
  json selected = json::array();
  for (const ecs::Entity entity : session.selection.entities(session.document))
    selected.push_back(session.document.nameOf(entity));
  const frame::StepCounts& counts = session.picture.counts;
  json settings = json::object();
  for (const frame::SettingRow& row : frame::settingRows())
    settings[std::string(row.name)] = frame::settingWord(row, session.stage.settings());
  return json{{"scenes", scenes},
              {"selected", selected},
              {"lights", session.document.world().lights},
              {"view", frame::wordOf(session.viewing.surfaces)},
              {"eye", poseWord(session.viewing.goal)},
              {"undo", session.history.undoName()},
              {"redo", session.history.redoName()},
              {"modified", session.files.modified()},
              {"world", session.files.world().string()},
              {"settings", settings},
              {"bytesResident", session.stage.world().residency().bytesResident()},
              {"groups", counts["groups"]},
              {"negativePixels", session.picture.negative_pixels},
              {"exposureEv", session.picture.exposure_ev},
              {"atRest", session.atRest()},
              {"handles", handlesJson(session)},
              {"frames", session.window.frames},
              {"pictures", session.picture.drawn},
              {"errors", session.log.errors()}};
}

Answer reference(Session& session) {
  json answer = {{"notice", session.reference.notice()}};
  if (const auto now = session.reference.snapshot()) answer["samples"] = now->spp;
  if (const auto& difference = session.reference.difference()) {
    const baker::PictureError& e = difference->figures;
    answer["relativeRms"] = e.relative_rms;
    answer["bias"] = e.bias;
    answer["percentile99"] = e.percentile_99;
    answer["pixels"] = e.pixels;
  }
  return answer;
}

Answer passes(Session& session) {
  json rows = json::array();
  for (const gpu::PassTime& pass : session.picture.passes)
    rows.push_back(
        {{"pass", pass.name}, {"cpuMs", pass.cpu_ms}, {"gpuMs", pass.gpu_ms}, {"reason", pass.reason}});
  return rows;
}

Answer tree(Session& session, Words words) {
  session.tree.query.filter = words.empty() ? std::string() : words[0];
  json rows = json::array();
  for (const TreeRow& row : session.tree.of(session.document))
    if (row.matches)
      rows.push_back({{"name", row.name}, {"kind", row.kind}, {"depth", row.depth}, {"id", idText(row.id)}});
  return rows;
}

Answer logEntries(Session& session) {
  constexpr std::array kWords = {"note", "warning", "error"};
  json rows = json::array();
  for (const LogEntry& entry : session.log.entries())
    rows.push_back({{"severity", kWords[static_cast<std::size_t>(entry.severity)]}, {"text", entry.text}});
  return rows;
}

constexpr std::size_t kMostWords = 16;

}  // namespace

std::vector<Command> stateCommands() {
  return {scripted("state", "Everything at a glance", "", 0, 0, state),
          scripted("get", "A field of what is selected or named", "[NAME:]COMPONENT.FIELD", 1, 1, get),
          scripted("set", "The same, given a value", "[NAME:]COMPONENT.FIELD VALUE...", 2, kMostWords, set),
          scripted("tree", "What the scene tree shows, searched", "[SEARCH]", 0, 1, tree),
          scripted("reference", "The reference beside: samples, difference", "", 0, 0, reference),
          scripted("passes", "Passes of the last frame, their times and why they ran", "", 0, 0, passes),
          scripted("log", "Notices and errors", "", 0, 0, logEntries)};
}

}  // namespace lambent::editor
