#pragma once

// What the tests of exports to LinuxCNC share: HAL, started without a screen.

#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/file.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>

#include "broken_input.hpp"
#include "exported.hpp"
#include "support/places.hpp"

namespace paracal::test {

/// HAL loads modules from its own folder only, so the two are installed, under a name that no machine uses.
class LinuxcncExport : public Export {
 protected:
  static inline const std::filesystem::path kModules = "/usr/lib/linuxcnc/modules";

  void SetUp() override {
    Export::SetUp();
    if (*PARACAL_HALCOMPILE == '\0') GTEST_SKIP() << "halcompile (linuxcnc-uspace-dev) is not installed";
    if (::access(kModules.c_str(), W_OK) != 0) GTEST_SKIP() << "installing into " << kModules << " needs root";
    lock_ = ::open("/tmp/paracal-hal.lock", O_CREAT | O_RDWR, 0666);
    ASSERT_EQ(::flock(lock_, LOCK_EX), 0);  // a machine has one HAL
    // Started by root, HAL becomes another user, who needs a socket and files to write.
    std::filesystem::permissions(folder.path(), std::filesystem::perms::all);
    static const std::string objection = [this] {
      folder.write("trial.hal", "loadrt or2\n");
      return halrun() == 0 ? "" : folder.read("halrun.log") + " ";
    }();
    if (!objection.empty()) GTEST_SKIP() << "HAL does not start here: " << objection;
  }

  void TearDown() override {
    end_what_still_runs();
    for (const char* module : {"paracal_trial.so", "paracal_probe.so"}) std::filesystem::remove(kModules / module);
    ::close(lock_);
  }

  /// A copy of the component under the name that is installed.
  void write_trial(const std::string& component) const {
    folder.write("paracal_trial.comp", replaced(component, "component paracal_kins ", "component paracal_trial "));
  }

  /// Compiled once in a process.
  int install(const std::string& component) const {
    static std::map<std::string, std::string> modules;  // by the text of their components
    std::string& module = modules[folder.read(component + ".comp")];
    const std::filesystem::path place = kModules / (component + ".so");
    if (!module.empty()) {
      std::ofstream(place, std::ios::binary) << module;
      return 0;
    }
    const int code = shell(fmt::format("{} --install {}.comp > halcompile.log 2>&1", PARACAL_HALCOMPILE, component));
    if (code == 0) module = read_text(place);
    return code;
  }

  /// Lets LinuxCNC run programs of the configuration's folder; with none of them it homes.
  nlohmann::json seen_while_running(const std::string& programs) const {
    const std::string ini =
        replaced(folder.read("machine/paracal.ini"), "DISPLAY = axis", "DISPLAY = ./linuxcnc_trial.py -- " + programs);
    folder.write("machine/paracal.ini", replaced(ini, "KINEMATICS = paracal_kins", "KINEMATICS = paracal_trial"));
    std::filesystem::copy(source_folder() / "tests/cli/linuxcnc_trial.py", folder.path() / "machine");
    EXPECT_EQ(in_hal("DISPLAY= timeout -k 10 120 linuxcnc -r machine/paracal.ini > linuxcnc.log 2>&1 < /dev/null"), 0);
    EXPECT_TRUE(exists(folder.path() / "machine/result.json")) << folder.read("linuxcnc.log");
    return nlohmann::json::parse(folder.read("machine/result.json"));
  }

  int halrun() const { return in_hal("timeout 120 halrun trial.hal > halrun.log 2>&1"); }

  /// Exit status of a command that starts HAL; its socket lies in the folder.
  int in_hal(const std::string& command) const {
    const char* const user = ::geteuid() == 0 ? "RTAPI_UID=65534" : "";
    return shell(fmt::format("HOME=$PWD {} RTAPI_FIFO_PATH=$PWD/socket {}", user, command));
  }

 private:
  /// Nothing of LinuxCNC outlives its test: whatever still works in the folder is a failure, and ended.
  void end_what_still_runs() const {
    for (const auto& process : std::filesystem::directory_iterator("/proc")) {
      std::error_code gone;
      const std::string where = std::filesystem::read_symlink(process.path() / "cwd", gone);
      if (!where.starts_with(folder.path().string())) continue;
      ADD_FAILURE() << "still runs: " << read_text(process.path() / "comm");
      ::kill(std::stoi(process.path().filename()), SIGKILL);
    }
  }

  int lock_ = -1;
};

}  // namespace paracal::test
