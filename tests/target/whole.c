/** An image that holds the whole library, for measuring. */
int main(void)
{
    return 0;
}
