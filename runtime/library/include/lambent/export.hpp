// Marks what the shared libraries show. Everything else in them is hidden.
#pragma once

#define LAMBENT_API __attribute__((visibility("default")))
