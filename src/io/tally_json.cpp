#include "tally_json.hpp"

#include <cmath>
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

Json accuracy_json(const Accuracy& accuracy) {
  Json json = Json::array();
  for (const ErrorKind kind : kErrorKinds) json.push_back(accuracy[kind]);
  return json;
}

/// Numbers that are not below zero.
double magnitude_of(const Json& json) {
  const double value = json.get<double>();
  if (!(value >= 0.0) || !std::isfinite(value)) throw std::out_of_range("magnitude");
  return value;
}

Accuracy accuracy_of(const Json& json) {
  Accuracy accuracy;
  for (const ErrorKind kind : kErrorKinds) accuracy[kind] = magnitude_of(json.at(static_cast<std::size_t>(kind)));
  return accuracy;
}

/// [machine, chance, fate, passes, before, after, the same two to first order, used up, that to first order]
Json pair_json(const MachinePair& pair) {
  return {pair.machine,
          pair.chance,
          static_cast<std::uint64_t>(pair.outcome.fate),
          pair.outcome.passes,
          accuracy_json(pair.outcome.before),
          accuracy_json(pair.outcome.after),
          accuracy_json(pair.first_order_before),
          accuracy_json(pair.first_order_after),
          pair.used_up,
          pair.first_order_used_up};
}

MachinePair pair_of(const Json& json) {
  MachinePair pair{.machine = json.at(0).get_ref<const std::uint64_t&>(),
                   .chance = magnitude_of(json.at(1)),
                   .outcome = {.fate = kFates.at(count_of(json.at(2), kFates.size() - 1)),
                               .passes = json.at(3).get<bool>(),
                               .before = accuracy_of(json.at(4)),
                               .after = accuracy_of(json.at(5))},
                   .first_order_before = accuracy_of(json.at(6)),
                   .first_order_after = accuracy_of(json.at(7)),
                   .used_up = magnitude_of(json.at(8)),
                   .first_order_used_up = magnitude_of(json.at(9))};
  if (!(pair.chance > 0.0) || pair.chance > 1.0) throw std::out_of_range("chance");
  return pair;
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

Json surrogate_json(const SurrogateTally& tally) {
  Json json{{"machines", tally.machines}, {"used_up", histogram_json(tally.used_up)}};
  add_histograms(tally.before, tally.after, json);
  json["pairs"] = Json::array();
  for (const MachinePair& pair : tally.pairs) json["pairs"].push_back(pair_json(pair));
  return json;
}

SurrogateTally surrogate_of(const Json& json, std::uint64_t machines) {
  SurrogateTally tally;
  tally.machines = count_of(json.at("machines"), machines);
  if (tally.machines != machines) throw std::out_of_range("machines");
  tally.used_up = histogram_of(json.at("used_up"), machines);
  read_histograms(json, machines, tally.before, tally.after);
  for (const Json& pair : json.at("pairs")) tally.pairs.push_back(pair_of(pair));
  return tally;
}

}  // namespace

Json tally_json(const Tally& tally) {
  Json json{{"fates", tally.fates}, {"passed", tally.passed}};
  add_histograms(tally.before, tally.after, json);
  if (tally.surrogate) json["surrogate"] = surrogate_json(*tally.surrogate);
  return json;
}

Tally tally_of(const Json& json, std::uint64_t machines) {
  Tally tally;
  for (const Fate fate : kFates) {
    tally.of(fate) = count_of(json.at("fates").at(static_cast<std::size_t>(fate)), machines);
  }
  if (const auto surrogate = json.find("surrogate"); surrogate != json.end()) {
    tally.surrogate = surrogate_of(*surrogate, machines);
  }
  const std::uint64_t produced = tally.surrogate ? tally.surrogate->pairs.size() : machines;
  if (tally.produced() != produced) throw std::out_of_range("machines");
  const std::uint64_t measured = produced - tally.of(Fate::does_not_close);
  tally.passed = count_of(json.at("passed"), measured);
  read_histograms(json, measured, tally.before, tally.after);
  return tally;
}

}  // namespace paracal::io
