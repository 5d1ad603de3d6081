// The compiled function bodies of coordinate_rates-inl.h.
#include <pliant/body/coordinate_rates-inl.h>
