#pragma once

#include "paracal/io/chunks.hpp"

namespace paracal::app {

/// Which of how many processes this is, as the launcher says in the environment: OMPI_COMM_WORLD_RANK and _SIZE (Open
/// MPI's mpirun), PMI_RANK and PMI_SIZE (MPICH and its kin), SLURM_PROCID and SLURM_NTASKS (srun), the first pair that
/// is set. The only one where no launcher speaks.
/// @throws WrongUsage for anything but a rank below a size.
io::Rank launched_rank();

}  // namespace paracal::app
