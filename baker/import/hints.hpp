// Advice that several errors of this room give.
#pragma once

namespace lambent::baker {

// For files that break the rules of glTF.
inline constexpr const char* kExportAgain = "export the scene again";

}  // namespace lambent::baker
