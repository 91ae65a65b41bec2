// All kinds of length, in the order of LengthKind.

#include <array>

#include "length_model.hpp"

namespace paracal {
namespace {

const std::array<const detail::LengthModel*, 3>& models() {
  static const std::array<const detail::LengthModel*, 3> kModels{&detail::heights(), &detail::ball_bar(),
                                                                 &detail::dial()};
  return kModels;
}

std::vector<LengthWords> all_words() {
  std::vector<LengthWords> all;
  for (const detail::LengthModel* model : models()) all.push_back(model->words());
  return all;
}

}  // namespace

const std::vector<LengthWords>& length_kinds() {
  static const std::vector<LengthWords> kWords = all_words();
  return kWords;
}

const LengthWords& words(LengthKind kind) { return length_kinds().at(static_cast<std::size_t>(kind)); }

const detail::LengthModel& detail::length_model(LengthKind kind) {
  return *models().at(static_cast<std::size_t>(kind));
}

}  // namespace paracal
