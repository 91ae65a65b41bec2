#pragma once

namespace paracal::io {

/// While an object of this class exists in any thread, SIGINT, SIGTERM and SIGHUP wait; then they are delivered as
/// usual. So operations of several calls, such as replacing a file, are completed first.
class SignalsWait {
 public:
  SignalsWait();
  ~SignalsWait();
  SignalsWait(const SignalsWait&) = delete;
  SignalsWait& operator=(const SignalsWait&) = delete;
};

}  // namespace paracal::io
