#include "editor/panels/colors.hpp"

namespace lambent::editor {

ImVec4 severityColor(Severity severity) {
  switch (severity) {
    case Severity::Error:
      return kErrorColor;
    case Severity::Warning:
      return kWarningColor;
    case Severity::Note:
      break;
  }
  return kNoteColor;
}

ImVec4 standingColor(Standing standing) {
  switch (standing) {
    case Standing::Failed:
      return kErrorColor;
    case Standing::Wanting:
      return kWarningColor;
    case Standing::Working:
      return kNoteColor;
    case Standing::Good:
      break;
  }
  return kGoodColor;
}

}  // namespace lambent::editor
