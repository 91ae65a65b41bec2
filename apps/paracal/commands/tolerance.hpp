#pragma once

#include "arguments.hpp"
#include "session.hpp"

namespace paracal::app {

/// The two halves of `paracal tolerance`.
void add_tolerance_allocate(Command& tolerance, Session& session);
void add_tolerance_analyze(Command& tolerance, Session& session);

}  // namespace paracal::app
