#pragma once

#include "session.hpp"

namespace paracal::app {

/// The two halves of `paracal tolerance`.
void add_tolerance_allocate(CLI::App& tolerance, Session& session);
void add_tolerance_analyze(CLI::App& tolerance, Session& session);

}  // namespace paracal::app
