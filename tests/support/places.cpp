#include "places.hpp"

namespace paracal::test {

std::filesystem::path source_folder() { return PARACAL_SOURCE; }
std::filesystem::path build_folder() { return PARACAL_BUILD; }

}  // namespace paracal::test
