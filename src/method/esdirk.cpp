// The library's instance of the function bodies in <pliant/method/esdirk-inl.h>.
#include <pliant/method/esdirk-inl.h>
