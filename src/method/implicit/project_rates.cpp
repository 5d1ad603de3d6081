// The library's instance of the function bodies in <pliant/method/implicit/project_rates-inl.h>.
#include <pliant/method/implicit/project_rates-inl.h>
