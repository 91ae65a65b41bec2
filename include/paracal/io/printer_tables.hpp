#pragma once

#include "paracal/io/file.hpp"
#include "paracal/printer/delta_geometry.hpp"

namespace paracal::io {

/// Measurements of an owner on a printer whose firmware stores no readings (CSV), in one of two kinds of table:
///
///   x_mm,y_mm,z_mm, optional height_mm     position shown by the firmware when the nozzle was height_mm (0 if not
///                                          stated) above the bed: a triggered probe, a sheet of paper
///   from_x_mm,from_y_mm,to_x_mm,to_y_mm,   two commanded print positions, and the distance between them by
///   distance_mm, optional z_mm             calliper; z_mm: height of the print there, 0 if not stated
///
/// and heightmap.csv of RepRapFirmware (1 to 3): a height for each probed point of its grid.
/// @param geometry  of the firmware during the measurements: it gives the joints.
/// @throws InputFileError for other tables, and for positions that the printer cannot reach.
DeltaReadings read_printer_table(const TextFile& file, const DeltaGeometry& geometry);

}  // namespace paracal::io
