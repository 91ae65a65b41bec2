#include "paracal/io/json.hpp"
#include "validation_fields.hpp"

namespace paracal::io {

Json to_json(const Validation& validation) { return stored(validation); }

}  // namespace paracal::io
