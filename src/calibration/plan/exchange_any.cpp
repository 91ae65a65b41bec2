#include "pose_exchange.hpp"

namespace paracal::detail {

template Selection exchange_poses<Eigen::Dynamic>(const Robot&, const std::vector<Station>&, const SelectionOptions&,
                                                  const Problem&, const PoseSpread&);

}  // namespace paracal::detail
