#include "launcher.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdlib>
#include <string_view>

#include "session.hpp"

namespace paracal::app {
namespace {

struct Names {
  const char* rank;
  const char* size;
};

constexpr std::array kLaunchers{Names{"OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"}, Names{"PMI_RANK", "PMI_SIZE"},
                                Names{"SLURM_PROCID", "SLURM_NTASKS"}};

std::uint64_t number_of(const char* name, std::string_view text) {
  if (const auto number = number_in<std::uint64_t>(text)) return *number;
  throw WrongUsage(fmt::format("{}: expected a whole number, got \"{}\"", name, text));
}

}  // namespace

io::Rank launched_rank() {
  for (const Names& names : kLaunchers) {
    const char *const rank_text = std::getenv(names.rank), *const size_text = std::getenv(names.size);
    if (rank_text == nullptr || size_text == nullptr) continue;
    const io::Rank rank{number_of(names.rank, rank_text), number_of(names.size, size_text)};
    if (rank.number < rank.size) return rank;
    throw WrongUsage(
        fmt::format("{}: expected a rank below {} = {}, got {}", names.rank, names.size, rank.size, rank.number));
  }
  return {};
}

}  // namespace paracal::app
