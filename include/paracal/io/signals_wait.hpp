#pragma once

namespace paracal::io {

/// While any of these lives, in whatever thread, SIGINT, SIGTERM and SIGHUP wait; then they are delivered as they would
/// have been. What takes several calls to be whole, as an output that replaces another, is whole then.
class SignalsWait {
 public:
  SignalsWait();
  ~SignalsWait();
  SignalsWait(const SignalsWait&) = delete;
  SignalsWait& operator=(const SignalsWait&) = delete;
};

}  // namespace paracal::io
