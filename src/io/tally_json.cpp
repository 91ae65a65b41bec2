#include "tally_json.hpp"

#include <stdexcept>
#include <string>

namespace paracal::io {
namespace {

/// @throws Json::exception for anything but a whole number, std::out_of_range for one above `most`.
std::uint64_t count_of(const Json& json, std::uint64_t most) {
  const auto& count = json.get_ref<const std::uint64_t&>();
  if (count > most) throw std::out_of_range("count");
  return count;
}

/// [[bin, count], ...]
Json histogram_json(const Histogram& histogram) {
  Json json = Json::array();
  for (const Histogram::Bin& bin : histogram.counts()) json.push_back({bin.number, bin.count});
  return json;
}

Histogram histogram_of(const Json& json, std::uint64_t machines) {
  Histogram histogram;
  for (const Json& bin : json) {
    const auto number = static_cast<std::uint32_t>(count_of(bin.at(0), Histogram::kBins - 1));
    histogram.add(number, count_of(bin.at(1), machines));
  }
  if (histogram.total() != machines) throw std::out_of_range("total");
  return histogram;
}

}  // namespace

Json tally_json(const Tally& tally) {
  Json json{{"fates", tally.fates}, {"passed", tally.passed}};
  for (const ErrorKind kind : kErrorKinds) {
    const std::string key(name(kind));
    json["before"][key] = histogram_json(tally.before[kind]);
    json["after"][key] = histogram_json(tally.after[kind]);
  }
  return json;
}

Tally tally_of(const Json& json, std::uint64_t machines) {
  Tally tally;
  for (const Fate fate : kFates) {
    tally.of(fate) = count_of(json.at("fates").at(static_cast<std::size_t>(fate)), machines);
  }
  if (tally.machines() != machines) throw std::out_of_range("machines");
  const std::uint64_t measured = machines - tally.of(Fate::does_not_close);
  tally.passed = count_of(json.at("passed"), measured);
  for (const ErrorKind kind : kErrorKinds) {
    const std::string key(name(kind));
    tally.before[kind] = histogram_of(json.at("before").at(key), measured);
    tally.after[kind] = histogram_of(json.at("after").at(key), measured);
  }
  return tally;
}

}  // namespace paracal::io
