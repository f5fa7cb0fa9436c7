#include <array>

#include "editor/commands/rows.hpp"
#include "editor/session/viewing.hpp"
#include "runtime/frame/frame_settings.hpp"
#include "runtime/spec/numbers.hpp"

namespace lambent::editor {

namespace {

using frame::SurfaceView;

Answer setView(Session& session, Words words) {
  const auto choice = frame::parseView(words[0]);
  if (!choice) return failAgain(choice.error());
  session.viewing.surfaces = *choice;
  session.viewing.changed = true;
  return nullptr;
}

template <SurfaceView View>
Answer show(Session& session, Words) {
  session.viewing.surfaces.view = View;
  session.viewing.changed = true;
  return nullptr;
}
template <SurfaceView View>
bool shows(const Session& session) {
  return session.viewing.surfaces.view == View;
}

Answer setSetting(Session& session, std::string name, std::string word) {
  frame::FrameSettings settings = session.stage.settings();
  if (auto put = frame::putSetting(settings, name, word); !put) return failAgain(put.error());
  session.history.editWorld(name, [&](WorldState& world) { world.settings[name] = std::move(word); });
  session.viewing.changed = true;
  return nullptr;
}
Answer setting(Session& session, Words words) {
  return setSetting(session, words[0], words[1]);
}

constexpr std::array kTransfers = {"unshadowed", "shadowed", "full"};
template <std::size_t Mode>
Answer transfer(Session& session, Words) {
  return setSetting(session, "transfer", kTransfers[Mode]);
}
template <std::size_t Mode>
bool transfers(const Session& session) {
  return static_cast<std::size_t>(session.stage.settings().transfer) == Mode;
}

Answer frameSelected(Session& session, Words) {
  session.viewing.frame(session.document, selectionBounds(session.document, session.selection));
  return nullptr;
}
Answer frameAll(Session& session, Words) {
  session.viewing.frame(session.document, {});
  return nullptr;
}
Answer setCamera(Session& session, Words words) {
  return answerOf(session.viewing.setCamera(session.document, words[0]));
}
Answer ortho(Session& session, Words) {
  session.viewing.goal.orthographic = session.viewing.pose.orthographic = !session.viewing.goal.orthographic;
  session.viewing.changed = true;
  return nullptr;
}
bool isOrtho(const Session& session) {
  return session.viewing.goal.orthographic;
}

template <SplitView Split>
Answer split(Session& session, Words) {
  SplitView& now = session.reference.split;
  now = now == Split ? SplitView::Off : Split;
  session.viewing.changed = true;
  return nullptr;
}
template <SplitView Split>
bool isSplit(const Session& session) {
  return session.reference.split == Split;
}
Answer samples(Session& session, Words words) {
  const auto number = spec::parseNumber(words[0]);
  if (!number || *number < 1.0f || *number > 1e6f)
    return fail("reference-samples", words[0] + " is not a number of samples", "give 1..1000000");
  session.reference.spp = static_cast<std::uint32_t>(*number);
  return nullptr;
}
Answer bands(Session& session, Words words) {
  if (words[0] == "off") {
    session.reference.band_limit.reset();
    return nullptr;
  }
  const auto number = spec::parseNumber(words[0]);
  if (!number || *number < 1.0f || *number > 8.0f)
    return fail("reference-bands", words[0] + " is not a number of bands", "give 1..8, or off");
  session.reference.band_limit = static_cast<int>(*number);
  return nullptr;
}

template <bool frame::OverlayOptions::*Switch>
Answer overlay(Session& session, Words) {
  session.viewing.overlays.*Switch = !(session.viewing.overlays.*Switch);
  session.viewing.changed = true;
  return nullptr;
}
template <bool frame::OverlayOptions::*Switch>
bool hasOverlay(const Session& session) {
  return session.viewing.overlays.*Switch;
}

Answer play(Session& session, Words) {
  session.playback.playing = !session.playback.playing;
  return nullptr;
}
bool plays(const Session& session) {
  return session.playback.playing;
}
Answer time(Session& session, Words words) {
  const auto seconds = spec::parseNumber(words[0]);
  if (!seconds || *seconds < 0.0f) return fail("time", words[0] + " is not a time", "give seconds");
  session.playback.time_s = *seconds;
  session.stage.world().setAnimationTime(*seconds);
  session.viewing.changed = true;
  return nullptr;
}

using O = frame::OverlayOptions;

constexpr std::array kViewRows = {
    toggle(&shows<SurfaceView::Final>,
           item("View", "view-final", "Final", "1", "The light as it is", &show<SurfaceView::Final>)),
    toggle(&shows<SurfaceView::Irradiance>,
           item("View", "view-irradiance", "Irradiance", "2",
                "What arrives at surfaces, without their own color", &show<SurfaceView::Irradiance>)),
    toggle(&shows<SurfaceView::TransferDc>,
           item("View", "view-dc", "Average visibility", "3", "What of uniform light arrives",
                &show<SurfaceView::TransferDc>)),
    toggle(&shows<SurfaceView::TransferBand>,
           item("View", "view-band", "One SH band", "4", "Energy of one band of the transfer",
                &show<SurfaceView::TransferBand>)),
    toggle(&shows<SurfaceView::ErrorEstimate>, item("View", "view-error", "Coding error", "5",
                                                    "What coding the transfer costs, as the bake measured it",
                                                    &show<SurfaceView::ErrorEstimate>)),
    toggle(&shows<SurfaceView::Importance>,
           item("View", "view-importance", "Importance", "6",
                "How much the bake took surfaces to matter to pictures", &show<SurfaceView::Importance>)),
    toggle(&shows<SurfaceView::ClusterIds>,
           item("View", "view-clusters", "Clusters", "7", "Which samples are coded together",
                &show<SurfaceView::ClusterIds>)),
    toggle(&shows<SurfaceView::Normals>,
           item("View", "view-normals", "Normals", "8", "Shading normals", &show<SurfaceView::Normals>)),
    toggle(&shows<SurfaceView::Wireframe>,
           item("View", "view-wireframe", "Wireframe", "9", "The triangles over the picture",
                &show<SurfaceView::Wireframe>)),
    scripted("view", "What surfaces show", "NAME[:BAND]", 1, 1, &setView),
    separator("View"),
    toggle(&transfers<0>, item("View", "unshadowed", "Unshadowed", "Shift+1",
                               "Light without shadows or bounces", &transfer<0>)),
    toggle(&transfers<1>,
           item("View", "shadowed", "Shadowed", "Shift+2", "With shadows, without bounces", &transfer<1>)),
    toggle(&transfers<2>,
           item("View", "full", "Shadows and bounces", "Shift+3", "All that was baked", &transfer<2>)),
    scripted("setting", "A setting of the frame, as the panel has them", "NAME VALUE", 2, 2, &setting),
    separator("View"),
    toggle(&isSplit<SplitView::Beside>,
           item("View", "split", "Reference beside", "F8",
                "The path-traced picture beside this one, refined in the background",
                &split<SplitView::Beside>)),
    toggle(&isSplit<SplitView::Heat>,
           item("View", "heat", "Difference from the reference", "Shift+F8",
                "Where the picture differs, and by how much", &split<SplitView::Heat>)),
    scripted("reference-samples", "Samples a pixel at which the reference ends", "N", 1, 1, &samples),
    scripted("reference-bands", "Light of the reference in so many bands only", "N|off", 1, 1, &bands),
    separator("View"),
    formerly("overlay-light-samples",
             toggle(&hasOverlay<&O::light_probes>,
                    item("View", "overlay-light-probes", "Light probes", "",
                         "What is captured where, and its harmonics as a ball", &overlay<&O::light_probes>))),
    toggle(&hasOverlay<&O::neighborhoods>,
           item("View", "overlay-neighborhoods", "Shadows around bodies", "",
                "What bodies change around them", &overlay<&O::neighborhoods>)),
    toggle(&hasOverlay<&O::volumes>, item("View", "overlay-volumes", "Volume bounds", "",
                                          "The boxes of volumes", &overlay<&O::volumes>)),
    toggle(&hasOverlay<&O::groups>, item("View", "overlay-groups", "Group bounds", "",
                                         "The boxes of rigid groups", &overlay<&O::groups>)),
    toggle(&hasOverlay<&O::lights>, item("View", "overlay-lights", "Lights", "",
                                         "Where lights stand, and where they shine", &overlay<&O::lights>)),
    toggle(&hasOverlay<&O::keys>,
           item("View", "overlay-keys", "Key lights", "",
                "Where key lights stand on the sky, and what their shadow maps show", &overlay<&O::keys>)),
    separator("View"),
    item("View", "frame", "Frame selection", "F", "What is selected fills the picture", &frameSelected),
    item("View", "frame-all", "Frame all", "Home", "All fills the picture", &frameAll),
    toggle(&isOrtho, item("View", "orthographic", "Orthographic", "O", "A view without perspective", &ortho)),
    scripted("camera", "Look from there: orbit:AZ,EL,DIST,FOV, pose:... or a camera's name", "CAMERA", 1, 1,
             &setCamera),
    toggle(&plays, item("View", "play", "Play animations", "Space", "Animations run", &play)),
    scripted("time", "Where animations stand", "SECONDS", 1, 1, &time),
};

}  // namespace

std::span<const Command> viewCommands() {
  return kViewRows;
}

namespace {

bool cameraSelected(const Session& session) {
  return session.document.registry().alive(selectedCamera(session));
}

// Returns the selected camera, or else the one whose picture is kept.
ecs::Entity cameraAtHand(const Session& session) {
  return cameraSelected(session) ? selectedCamera(session) : shownCamera(session);
}
bool anyCamera(const Session& session) {
  return session.document.registry().alive(cameraAtHand(session));
}

Answer look(Session& session, Words) {
  lookThrough(session, cameraAtHand(session));
  return nullptr;
}
Answer keep(Session& session, Words) {
  ecs::Entity& kept = session.viewing.kept_camera;
  const ecs::Entity selected = selectedCamera(session);  // none gives up the kept one
  kept = kept == selected ? ecs::Entity{} : selected;
  return nullptr;
}
bool keeps(const Session& session) {
  return session.document.registry().alive(session.viewing.kept_camera);
}
bool mayKeep(const Session& session) {
  return cameraSelected(session) || keeps(session);
}
Answer place(Session& session, Words) {
  return answerOf(placeAtView(session, selectedCamera(session)));
}
Answer preview(Session& session, Words) {
  session.preferences.camera_preview = !session.preferences.camera_preview;
  return nullptr;
}
bool previews(const Session& session) {
  return session.preferences.camera_preview;
}

constexpr std::array kCameraRows = {
    separator("View"),
    enabled(&anyCamera,
            item("View", "look-through", "Look through this camera", "C",
                 "The view goes where the selected camera stands, or the one whose picture is kept", &look)),
    enabled(&cameraSelected, item("View", "camera-to-view", "Camera to view", "Shift+C",
                                  "The selected camera goes where the view is", &place)),
    toggle(&previews, item("View", "camera-preview", "Camera preview", "",
                           "An inset in the view shows what a selected camera sees", &preview)),
    enabled(&mayKeep,
            toggle(&keeps,
                   item("View", "keep-camera", "Keep this camera's picture", "",
                        "The inset stays while other things are selected and edited: a second view", &keep))),
};

}  // namespace

std::span<const Command> cameraCommands() {
  return kCameraRows;
}

}  // namespace lambent::editor
