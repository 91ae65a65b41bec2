#include "serial.hpp"
