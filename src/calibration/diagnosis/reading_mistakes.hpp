#pragma once

// Private to calibration: readings as they would have been without a mistake.

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "paracal/calibration/measurement.hpp"

namespace paracal::detail {

bool reads_rotation(const Measurements& measurements);
bool reads_second(const Measurements& measurements);
bool reads_orientation(const Measurements& measurements);
bool reads_lengths(const Measurements& measurements, LengthKind kind);
/// Some station was read more than once in a series.
bool has_repeats(const Measurements& measurements);

/// Points, distances and lengths times a factor. Stated sigmas stay: nobody knows what unit they are in, and a fit
/// that seeks the scale of the noise does not ask.
void scale_readings(Measurements& measurements, double factor);
void scale_points(PointSeries& series, double factor);
void scale_lengths(LengthSeries& series, double factor);
void scale_distances(Measurements& measurements, double factor);
/// Readings of phi times a factor.
void scale_rotations(Measurements& measurements, double factor);
void change_orientations(Measurements& measurements, const std::function<Quaternion(const Quaternion&)>& change);
void negate_lengths(Measurements& measurements, LengthKind kind);
/// Points, both reflectors, times a matrix.
void turn_readings(Measurements& measurements, const Eigen::Matrix3d& turn);
/// The 47 ways to exchange axes and their signs.
std::vector<Eigen::Matrix3d> exchanges_of_axes();

/// Every reading gets the station, or the pair of stations, of the row `by` rows further down; at the end the table
/// begins anew.
void shift_rows(Measurements& measurements, int by);
/// Every reading gets the station `by` places further down the list of stations.
void shift_stations(Measurements& measurements, int by);

}  // namespace paracal::detail
