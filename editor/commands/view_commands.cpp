// Implements the commands for the view: what surfaces show, the reference, overlays, the camera, and the
// handles.
#include <algorithm>
#include <array>

#include "editor/commands/rows.hpp"
#include "runtime/frame/frame_settings.hpp"
#include "runtime/spec/numbers.hpp"

namespace lambent::editor {

namespace {

using frame::SurfaceView;

Command viewOf(SurfaceView view, const char* id, const char* title, const char* shortcut, const char* help) {
  return item(id, title, shortcut, help,
              [view](Session& session) {
                session.viewing.surfaces.view = view;
                session.viewing.changed = true;
              })
      .checkedIf([view](const Session& session) { return session.viewing.surfaces.view == view; });
}

Result<void> setView(Session& session, Words words) {
  return frame::parseView(words[0]).map([&](const frame::ViewChoice& view) {
    session.viewing.surfaces = view;
    session.viewing.changed = true;
  });
}

Result<void> setSetting(Session& session, const std::string& name, const std::string& word) {
  frame::FrameSettings settings = session.stage.settings();
  if (auto put = frame::putSetting(settings, name, word); !put) return put;
  session.history.editWorld(name, [&](WorldState& world) { world.settings[name] = word; });
  session.viewing.changed = true;
  return {};
}

Command transferOf(std::size_t mode, const char* word, const char* title, const char* shortcut,
                   const char* help) {
  return item(word, title, shortcut, help,
              [word](Session& session) { return setSetting(session, "transfer", word); })
      .checkedIf([mode](const Session& session) {
        return static_cast<std::size_t>(session.stage.settings().transfer) == mode;
      });
}

Command splitOf(SplitView split, const char* id, const char* title, const char* shortcut, const char* help) {
  return item(id, title, shortcut, help,
              [split](Session& session) {
                SplitView& now = session.reference.split;
                now = now == split ? SplitView::Off : split;
                session.viewing.changed = true;
              })
      .checkedIf([split](const Session& session) { return session.reference.split == split; });
}

Command overlayOf(bool frame::OverlayOptions::*flag, const char* id, const char* title, const char* help) {
  return toggle(
      id, title, "", help, [flag](auto& session) -> auto& { return session.viewing.overlays.*flag; });
}

// Returns the word as a number within these limits, or an error that names them.
Result<float> numberWithin(const char* subject, const std::string& word, float least, float most,
                           const char* what, const char* hint) {
  const auto number = spec::parseNumber(word);
  if (!number || *number < least || *number > most)
    return fail(subject, fmt::format("{} is not {}", word, what), hint);
  return *number;
}

Result<void> setSamples(Session& session, Words words) {
  return numberWithin("reference-samples", words[0], 1.0f, 1e6f, "a number of samples", "give 1..1000000")
      .map([&](float number) { session.reference.spp = static_cast<std::uint32_t>(number); });
}

Result<void> setBands(Session& session, Words words) {
  session.reference.band_limit.reset();
  if (words[0] == "off") return {};
  return numberWithin("reference-bands", words[0], 1.0f, 8.0f, "a number of bands", "give 1..8, or off")
      .map([&](float number) { session.reference.band_limit = static_cast<int>(number); });
}

Result<void> setTime(Session& session, Words words) {
  return numberWithin("time", words[0], 0.0f, 1e9f, "a time", "give seconds").map([&](float seconds) {
    session.playback.time_s = seconds;
    session.stage.world().setAnimationTime(seconds);
    session.viewing.changed = true;
  });
}

bool cameraSelected(const Session& session) {
  return session.document.registry().alive(selectedCamera(session));
}
Command modeOf(GizmoMode mode, const char* title, const char* shortcut, const char* help) {
  return item(kModes[static_cast<std::size_t>(mode)], title, shortcut, help,
              [mode](Session& session) {
                session.handles.gizmo.options.mode = mode;
                session.handles.shown = true;
              })
      .checkedIf([mode](const Session& session) {
        return session.handles.shown && session.handles.gizmo.options.mode == mode;
      });
}

void switchAxes(Session& session) {
  GizmoSpace& now = session.handles.gizmo.options.space;
  now = now == GizmoSpace::World ? GizmoSpace::Local : GizmoSpace::World;
}

// Switches snapping, or switches it on with these steps; 0 metres switch it off.
Answer setSnap(Session& session, Words words) {
  GizmoOptions& now = session.handles.gizmo.options;
  if (words.empty()) return now.snap = !now.snap;
  std::vector<float> given;
  for (const std::string& word : words) {
    const auto step = spec::parseNumber(word);
    const bool off = given.empty() && words.size() == 1 && step && *step == 0.0f;
    if (!step || (!off && !(*step > 0.0f)))
      return fail("snap", word + " is not a step",
                  "give metres, degrees and a factor above 0, or 0 for none");
    given.push_back(*step);
  }
  now.snap = given[0] > 0.0f;
  const std::array steps = {&now.snap_m, &now.snap_deg, &now.snap_scale};
  for (std::size_t i = 0; now.snap && i < given.size(); ++i) *steps[i] = given[i];
  return now.snap;
}

}  // namespace

std::vector<Command> viewCommands() {
  using O = frame::OverlayOptions;
  return inMenu(
      "View",
      {viewOf(SurfaceView::Final, "view-final", "Final", "1", "The light as it is"),
       viewOf(SurfaceView::Irradiance, "view-irradiance", "Irradiance", "2",
              "What arrives at surfaces, without their own color"),
       viewOf(SurfaceView::TransferDc, "view-dc", "Average visibility", "3", "What of uniform light arrives"),
       viewOf(SurfaceView::ErrorEstimate, "view-error", "Coding error", "5",
              "What coding the transfer costs, as the bake measured it"),
       viewOf(SurfaceView::Importance, "view-importance", "Importance", "6",
              "How much the bake took surfaces to matter to pictures"),
       viewOf(SurfaceView::ClusterIds, "view-clusters", "Clusters", "7", "Which samples are coded together"),
       viewOf(SurfaceView::Normals, "view-normals", "Normals", "8", "Shading normals"),
       viewOf(SurfaceView::Wireframe, "view-wireframe", "Wireframe", "9", "The triangles over the picture"),
       scripted("view", "What surfaces show", "NAME", 1, 1, setView),
       separator(),
       transferOf(0, "unshadowed", "Unshadowed", "Shift+1", "Light without shadows or bounces"),
       transferOf(1, "shadowed", "Shadowed", "Shift+2", "With shadows, without bounces"),
       transferOf(2, "full", "Shadows and bounces", "Shift+3", "All that was baked"),
       scripted("setting", "A setting of the frame, as the panel has them", "NAME VALUE", 2, 2,
                [](Session& session, Words words) { return setSetting(session, words[0], words[1]); }),
       separator(),
       splitOf(SplitView::Beside, "split", "Reference beside", "F8",
               "The path-traced picture beside this one, refined in the background"),
       splitOf(SplitView::Heat, "heat", "Difference from the reference", "Shift+F8",
               "Where the picture differs, and by how much"),
       scripted("reference-samples", "Samples a pixel at which the reference ends", "N", 1, 1, setSamples),
       scripted("reference-bands", "Light of the reference in so many bands only", "N|off", 1, 1, setBands),
       separator(),
       overlayOf(&O::light_probes, "overlay-light-probes", "Light probes",
                 "What is captured where, and its harmonics as a ball"),
       overlayOf(&O::neighborhoods, "overlay-neighborhoods", "Shadows around bodies",
                 "What bodies change around them"),
       overlayOf(&O::volumes, "overlay-volumes", "Volume bounds", "The boxes of volumes"),
       overlayOf(&O::groups, "overlay-groups", "Group bounds", "The boxes of rigid groups"),
       overlayOf(&O::lights, "overlay-lights", "Lights", "Where lights stand, and where they shine"),
       overlayOf(&O::keys, "overlay-keys", "Key lights",
                 "Where key lights stand on the sky, and what their shadow maps show"),
       separator(),
       item("frame", "Frame selection", "F", "What is selected fills the picture",
            [](Session& session) {
              session.viewing.frame(session.document, selectionBounds(session.document, session.selection));
            }),
       item("frame-all", "Frame all", "Home", "All fills the picture",
            [](Session& session) { session.viewing.frame(session.document, {}); }),
       item("orthographic", "Orthographic", "O", "A view without perspective",
            [](Session& session) {
              Viewing& viewing = session.viewing;
              viewing.goal.orthographic = viewing.pose.orthographic = !viewing.goal.orthographic;
              viewing.changed = true;
            })
           .checkedIf([](const Session& session) { return session.viewing.goal.orthographic; }),
       scripted("camera", "Look from there: orbit:AZ,EL,DIST,FOV, pose:... or a camera's name", "CAMERA", 1,
                1,
                [](Session& session, Words words) {
                  return session.viewing.setCamera(session.document, words[0]);
                }),
       toggle(
           "play", "Play animations", "Space", "Animations run",
           [](auto& session) -> auto& { return session.playback.playing; }),
       scripted("time", "Where animations stand", "SECONDS", 1, 1, setTime),
       separator(),
       modeOf(GizmoMode::Move, "Move", "W", "Handles that move what is selected"),
       modeOf(GizmoMode::Rotate, "Turn", "E", "Handles that turn what is selected"),
       modeOf(GizmoMode::Scale, "Scale", "R", "Handles that scale what is selected"),
       item("local-axes", "Local axes", "X", "Handles along the axes of what is selected, not of the world",
            switchAxes)
           .checkedIf([](const Session& session) {
             return session.handles.gizmo.options.space == GizmoSpace::Local;
           }),
       item("snap", "Snap", "Y", "Drags go in steps; Ctrl does so for one drag, or frees it", setSnap)
           .taking("[METRES [DEGREES [FACTOR]]]", 0, 3)
           .checkedIf([](const Session& session) { return session.handles.gizmo.options.snap; }),
       toggle(
           "gizmos", "Handles", "G", "Show handles at all",
           [](auto& session) -> auto& { return session.handles.shown; }),
       separator(),
       item("look-through", "Look through this camera", "C", "The view goes where the selected camera stands",
            [](Session& session) { lookThrough(session, selectedCamera(session)); })
           .onlyIf(cameraSelected),
       item("camera-to-view", "Camera to view", "Shift+C", "The selected camera goes where the view is",
            [](Session& session) { return placeAtView(session, selectedCamera(session)); })
           .onlyIf(cameraSelected)});
}

// Implements the commands for the window: layouts, docks, panels, and help.

namespace {

// Shows or hides a dock. Where only the view is shown, all come back.
Command dockOf(Dock dock, const char* id, const char* title, const char* help) {
  return item(id, title, "", help,
              [dock](Session& session) {
                WindowLayout& layout = session.preferences.layout;
                bool& shown = layout.of(dock).shown;
                shown = layout.view_only || !shown;
                layout.view_only = false;
              })
      .checkedIf([dock](const Session& session) {
        const WindowLayout& layout = session.preferences.layout;
        return layout.of(dock).shown && !layout.view_only;
      });
}

void showAbout(Session& session) {
  session.window.dialog = Dialog{.title = "Lambent " LAMBENT_VERSION,
                                 .question =
                                     "Bake a glTF scene once, light it any way you like.\n"
                                     "Precomputed radiance transfer: Sloan, Kautz and Snyder, SIGGRAPH 2002.",
                                 .yes = "Close",
                                 .no = ""};
}

void showKeys(Session& session) {
  std::string text;
  for (const Command& command : commandList())
    if (*command.shortcut != '\0') text += fmt::format("{}: {}\n", command.shortcut, command.title);
  text +=
      "\nMiddle drag: orbit; also Alt and the left button\nShift+middle: pan\nWheel: nearer, farther\n"
      "Right drag: look around\nRight+WASDQE: fly; with Shift faster\nRight click: menu of the selection\n"
      "Click: select; with Ctrl or Shift several\nShift+drag: finer numbers and handles\n"
      "Ctrl+drag: handles in steps, or freely\nAlt+drag: coarser numbers\n"
      "Double click in the tree: frame";
  session.window.dialog =
      Dialog{.title = "Keys and pointer", .question = std::move(text), .yes = "Close", .no = ""};
}

Answer listCommands(Session&) {
  nlohmann::json rows = nlohmann::json::array();
  for (const Command& command : commandList())
    if (*command.id != '\0')
      rows.push_back({{"id", command.id},
                      {"arguments", command.arguments},
                      {"help", command.help},
                      {"menu", command.menu},
                      {"title", command.title},
                      {"shortcut", command.shortcut}});
  return rows;
}

}  // namespace

std::vector<Command> windowCommands() {
  std::vector<Command> window = inMenu(
      "Window",
      {toggle(
           "view-only", "Picture only", "F11", "The view fills the window; again, all panels are back",
           [](auto& session) -> auto& { return session.preferences.layout.view_only; }),
       separator(),
       item("layout-default", "Reset layout", "", "All panels are back where they were at first",
            [](Session& session) {
              session.preferences.layout = {};
              session.window.raise_tabs = true;
            }),
       separator(), dockOf(Dock::Left, "left-panels", "Left panels", "The scene tree"),
       dockOf(Dock::Right, "right-panels", "Right panels", "Inspector, light, settings"),
       dockOf(Dock::Bottom, "bottom-panels", "Bottom panels", "Bakes, cost, log"),
       scripted("panel", "Bring a panel up", "NAME", 1, 1,
                [](Session& session, Words words) { session.window.wanted_panels.push_back(words[0]); })});
  const std::vector<Command> help =
      inMenu("Help", {item("shortcuts", "Keys and pointer", "F1",
                           "All keys, and what the pointer does in the view", showKeys),
                      item("about", "About", "", "Version and origin", showAbout),
                      scripted("commands", "All commands, as JSON", "", 0, 0, listCommands)});
  window.insert(window.end(), help.begin(), help.end());
  return window;
}

}  // namespace lambent::editor
