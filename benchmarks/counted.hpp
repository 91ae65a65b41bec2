#pragma once

#include <Eigen/Core>
#include <cmath>

namespace paracal::benchmark {

/// Floating point work. Copies, signs, comparisons and absolute values are free.
struct Operations {
  double arithmetic = 0.0;  ///< + - * / and square roots, one each
  double functions = 0.0;   ///< calls of sin, cos, atan2

  friend Operations operator+(Operations a, Operations b) {
    return {a.arithmetic + b.arithmetic, a.functions + b.functions};
  }
  friend Operations operator-(Operations a, Operations b) {
    return {a.arithmetic - b.arithmetic, a.functions - b.functions};
  }
  friend Operations operator*(double times, Operations a) { return {times * a.arithmetic, times * a.functions}; }
};

/// A double that keeps count of the work done with it.
struct Counted {
  double value = 0.0;
  static inline Operations total;

  Counted() = default;
  Counted(double number) : value(number) {}

  static Counted arithmetic(double result) {
    ++total.arithmetic;
    return result;
  }
  static Counted function(double result) {
    ++total.functions;
    return result;
  }

  friend Counted operator+(Counted a, Counted b) { return arithmetic(a.value + b.value); }
  friend Counted operator-(Counted a, Counted b) { return arithmetic(a.value - b.value); }
  friend Counted operator*(Counted a, Counted b) { return arithmetic(a.value * b.value); }
  friend Counted operator/(Counted a, Counted b) { return arithmetic(a.value / b.value); }
  friend Counted operator-(Counted a) { return -a.value; }
  Counted& operator+=(Counted other) { return *this = *this + other; }
  Counted& operator-=(Counted other) { return *this = *this - other; }
  Counted& operator*=(Counted other) { return *this = *this * other; }
  Counted& operator/=(Counted other) { return *this = *this / other; }
  friend auto operator<=>(Counted a, Counted b) { return a.value <=> b.value; }
  friend bool operator==(Counted a, Counted b) { return a.value == b.value; }

  friend Counted sqrt(Counted a) { return arithmetic(std::sqrt(a.value)); }
  friend Counted sin(Counted a) { return function(std::sin(a.value)); }
  friend Counted cos(Counted a) { return function(std::cos(a.value)); }
  friend Counted abs(Counted a) { return std::abs(a.value); }
  friend Counted abs2(Counted a) { return a * a; }
};

/// The work of one call of `task`.
template <typename Task>
Operations count(Task&& task) {
  Counted::total = {};
  task();
  return Counted::total;
}

}  // namespace paracal::benchmark

template <>
struct Eigen::NumTraits<paracal::benchmark::Counted> : Eigen::NumTraits<double> {
  using Real = paracal::benchmark::Counted;
  using NonInteger = paracal::benchmark::Counted;
  using Nested = paracal::benchmark::Counted;
  using Literal = paracal::benchmark::Counted;
};
