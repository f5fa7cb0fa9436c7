// Opens the user's browser.
#pragma once

#include <string>

namespace lambent::baker {

// Asks xdg-open to show an address and does not wait for it. Returns false where there is no display or no
// xdg-open. An interrupt from the terminal does not reach the browser.
bool openBrowser(const std::string& address);

}  // namespace lambent::baker
