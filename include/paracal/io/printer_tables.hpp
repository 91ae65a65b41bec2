#pragma once

#include "paracal/io/file.hpp"
#include "paracal/printer/delta_geometry.hpp"

namespace paracal::io {

/// What an owner measured on a printer whose firmware keeps no readings (CSV), as one of two kinds of table:
///
///   x_mm,y_mm,z_mm, optional height_mm     where the firmware believed the nozzle when it stood height_mm (0 where not
///                                          stated) above the bed: a probe that triggered, a sheet of paper
///   from_x_mm,from_y_mm,to_x_mm,to_y_mm,   two places that the firmware was told to print at, and the calliper's
///   distance_mm, optional z_mm             distance between them; z_mm: height of the print there, 0 where not stated
///
/// @param geometry  that the firmware had when it was measured: it says how the joints stood.
/// @throws InputFileError for other tables, and for places that the printer does not reach.
DeltaReadings read_printer_table(const TextFile& file, const DeltaGeometry& geometry);

}  // namespace paracal::io
