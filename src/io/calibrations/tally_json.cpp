#include "paracal/io/tally_json.hpp"

#include <array>
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

/// @throws Json::exception for anything but a list, std::out_of_range for one of another length.
const Json::array_t& list_of(const Json& json, std::size_t size) {
  const auto& list = json.get_ref<const Json::array_t&>();
  if (list.size() != size) throw std::out_of_range("list");
  return list;
}

/// [first bin, its count, that of the next, ...]: half as long as pairs, and packs three times as well.
Json histogram_json(const Histogram& histogram) {
  Json json = Json::array();
  for (const auto& [bin, count] : histogram.counts()) {
    if (json.empty()) json.push_back(bin);
    const std::uint64_t first = json[0].get<std::uint64_t>();
    while (first + json.size() - 1 < bin) json.push_back(0U);
    json.push_back(count);
  }
  return json;
}

Histogram histogram_of(const Json& json, std::uint64_t machines) {
  Histogram histogram;
  const auto& entries = json.get_ref<const Json::array_t&>();
  const std::uint64_t first = entries.empty() ? 0 : count_of(entries[0], Histogram::kBins - 1);
  for (std::size_t k = 1; k < entries.size(); ++k) {
    const std::uint64_t bin = first + k - 1;
    if (bin >= Histogram::kBins) throw std::out_of_range("bin");
    histogram.add(static_cast<std::uint32_t>(bin), count_of(entries[k], machines));
  }
  if (histogram.total() != machines) throw std::out_of_range("total");
  return histogram;
}

/// {before: {...}, after: {...}}
void add_histograms(const PerErrorKind<Histogram>& before, const PerErrorKind<Histogram>& after, Json& json) {
  for (const ErrorKind kind : kErrorKinds) {
    const std::string key(name(kind));
    json["before"][key] = histogram_json(before[kind]);
    json["after"][key] = histogram_json(after[kind]);
  }
}

void read_histograms(const Json& json, std::uint64_t machines, PerErrorKind<Histogram>& before,
                     PerErrorKind<Histogram>& after) {
  for (const ErrorKind kind : kErrorKinds) {
    const std::string key(name(kind));
    before[kind] = histogram_of(json.at("before").at(key), machines);
    after[kind] = histogram_of(json.at("after").at(key), machines);
  }
}

Json first_order_json(const FirstOrderTally& tally) {
  Json json{{"machines", tally.machines}, {"used_up", histogram_json(tally.used_up)}};
  add_histograms(tally.before, tally.after, json);
  return json;
}

FirstOrderTally first_order_of(const Json& json) {
  FirstOrderTally tally;
  tally.machines = json.at("machines").get_ref<const std::uint64_t&>();
  tally.used_up = histogram_of(json.at("used_up"), tally.machines);
  read_histograms(json, tally.machines, tally.before, tally.after);
  return tally;
}

// ---- pairs, column by column: numbers that are alike stand together

constexpr std::size_t kBinsOfAMachine = 2 * kErrorKinds.size() + 1;

/// Before, after, used up.
template <typename Bins>
auto bins_in_order(Bins& bins) {
  std::array<decltype(&bins.used_up), kBinsOfAMachine> all{};
  std::size_t place = 0;
  for (auto* when : {&bins.before, &bins.after}) {
    for (const ErrorKind kind : kErrorKinds) all[place++] = &(*when)[kind];
  }
  all[place] = &bins.used_up;
  return all;
}

Json columns_json(const std::vector<MachinePair>& pairs, ErrorBins MachinePair::*which) {
  Json columns = Json::array();
  for (std::size_t k = 0; k < kBinsOfAMachine; ++k) {
    columns.push_back(json_array(pairs, [&](const MachinePair& pair) { return *bins_in_order(pair.*which)[k]; }));
  }
  return columns;
}

void read_columns(const Json& columns, std::vector<MachinePair>& pairs, ErrorBins MachinePair::*which) {
  const auto& all = list_of(columns, kBinsOfAMachine);
  for (std::size_t k = 0; k < kBinsOfAMachine; ++k) {
    const auto& column = list_of(all[k], pairs.size());
    for (std::size_t row = 0; row < pairs.size(); ++row) {
      *bins_in_order(pairs[row].*which)[k] = static_cast<std::uint32_t>(count_of(column[row], Histogram::kBins - 1));
    }
  }
}

Json pairs_json(const std::vector<MachinePair>& pairs) {
  return {{"machine", json_array(pairs, [](const MachinePair& pair) { return pair.machine; })},
          {"fate", json_array(pairs, [](const MachinePair& pair) { return static_cast<std::uint64_t>(pair.fate); })},
          {"passes", json_array(pairs, [](const MachinePair& pair) { return pair.passes ? 1U : 0U; })},
          {"first_order", columns_json(pairs, &MachinePair::first_order)},
          {"exact", columns_json(pairs, &MachinePair::exact)}};
}

std::vector<MachinePair> pairs_of(const Json& json) {
  const auto& machine = json.at("machine").get_ref<const Json::array_t&>();
  std::vector<MachinePair> pairs(machine.size());
  const auto &fate = list_of(json.at("fate"), pairs.size()), &passes = list_of(json.at("passes"), pairs.size());
  for (std::size_t row = 0; row < pairs.size(); ++row) {
    pairs[row].machine = machine[row].get_ref<const std::uint64_t&>();
    pairs[row].fate = kFates.at(count_of(fate[row], kFates.size() - 1));
    pairs[row].passes = count_of(passes[row], 1) == 1;
  }
  read_columns(json.at("first_order"), pairs, &MachinePair::first_order);
  read_columns(json.at("exact"), pairs, &MachinePair::exact);
  return pairs;
}

}  // namespace

Json tally_json(const Tally& tally) {
  Json json{{"fates", tally.fates}, {"passed", tally.passed}};
  if (tally.first_order) json["first_order"] = first_order_json(*tally.first_order);
  if (tally.first_order || !tally.pairs.empty()) {
    json["pairs"] = pairs_json(tally.pairs);
  } else {
    add_histograms(tally.before, tally.after, json);
  }
  return json;
}

Tally tally_of(const Json& json) {
  Tally tally;
  const auto& fates = list_of(json.at("fates"), kFates.size());
  for (const Fate fate : kFates) {
    tally.of(fate) = fates[static_cast<std::size_t>(fate)].get_ref<const std::uint64_t&>();
  }
  const std::uint64_t measured = tally.produced() - tally.of(Fate::does_not_close);
  tally.passed = count_of(json.at("passed"), measured);
  if (const auto first_order = json.find("first_order"); first_order != json.end()) {
    tally.first_order = first_order_of(*first_order);
  }
  if (const auto pairs = json.find("pairs"); pairs != json.end()) {
    tally.pairs = pairs_of(*pairs);
    if (tally.pairs.size() != tally.produced()) throw std::out_of_range("pairs");
  } else {
    read_histograms(json, measured, tally.before, tally.after);
  }
  return tally;
}

}  // namespace paracal::io
