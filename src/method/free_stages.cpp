// The library's instance of the function bodies in <pliant/method/free_stages-inl.h>.
#include <pliant/method/free_stages-inl.h>
