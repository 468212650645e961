# docker build -t toothspace . && docker run --rm -v "$PWD:/cases" toothspace run egm12_pump
FROM python:3.11-slim AS build
WORKDIR /source
COPY . .
RUN apt-get update && apt-get install -y --no-install-recommends git \
    && pip install --no-cache-dir hatchling && python -m hatchling build -t wheel -d /wheel

FROM python:3.11-slim
COPY --from=build /wheel /wheel
RUN pip install --no-cache-dir /wheel/*.whl && rm -r /wheel
# compiled code stands in the image: on processors like that of the build no container compiles again
ENV TOOTHSPACE_CACHE=/var/cache
RUN toothspace warmup && chmod -R a+rwX /var/cache
WORKDIR /cases
ENTRYPOINT ["toothspace"]
CMD ["--help"]
