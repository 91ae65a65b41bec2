#include "pose_exchange.hpp"

namespace paracal::detail {

template Selection exchange_poses<3>(const Robot&, const std::vector<Station>&, const SelectionOptions&, const Problem&,
                                     const PoseSpread&);

}  // namespace paracal::detail
