#include "lib/product_kernels.hpp"

HB_PRODUCTS(, double);
HB_PRODUCTS(, std::complex<double>);
HB_MIXED_PRODUCTS(, double, std::complex<double>);
