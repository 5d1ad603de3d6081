// The library's instance of the function bodies in <pliant/method/implicit/stiff_projection_metric-inl.h>.
#include <pliant/method/implicit/stiff_projection_metric-inl.h>
